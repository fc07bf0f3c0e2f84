//! The record of a board: pulses, conversions, resets, irregularities and log lines.

use crate::time::{Ticks, to_duration};
use std::fmt;

/// A violation of the manual by the program, or its use of a function that is not modelled. Every model reports both,
/// so nothing passes in silence.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Irregularity {
    /// An access to an unmapped address.
    Unmapped {
        /// The address.
        address: u32,
    },
    /// An access to a peripheral whose clock is off (RM0008 7.3.6-7.3.8).
    Unclocked {
        /// The address.
        address: u32,
    },
    /// A peripheral register accessed by less than it may be: most by words only.
    Narrow {
        /// The address.
        address: u32,
    },
    /// A function of the chip that is not modelled.
    NotModelled(&'static str),
    /// Against a rule of the reference manual.
    AgainstTheManual(&'static str),
    /// A trigger came while the ADC was converting: a sample is missing.
    TriggerWhileBusy,
    /// A conversion that was started by software (RM0008 11.12.3): it is not on the grid.
    StartedBySoftware,
    /// The DMA completed a half of its ring before the program had acknowledged the one before.
    DmaOverrun {
        /// The channel.
        channel: u8,
    },
    /// The receiver had no room for a byte (RM0008 27.6.1, ORE).
    ReceiverOverrun,
    /// The processor met a fault.
    Fault {
        /// Program counter.
        pc: u32,
    },
}

/// An [`Irregularity`] with its time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Violation {
    /// Its time.
    pub at: Ticks,
    /// The irregularity.
    pub what: Irregularity,
}

impl fmt::Display for Violation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:.6} s: ", to_duration(self.at).as_secs_f64())?;
        match self.what {
            Irregularity::Unmapped { address } => write!(f, "nothing is at {address:#010x}"),
            Irregularity::Unclocked { address } => {
                write!(f, "{address:#010x} accessed without a clock")
            }
            Irregularity::Narrow { address } => {
                write!(f, "{address:#010x} accessed by less than its register")
            }
            Irregularity::NotModelled(what) => write!(f, "not modelled: {what}"),
            Irregularity::AgainstTheManual(what) => write!(f, "against RM0008: {what}"),
            Irregularity::TriggerWhileBusy => f.write_str("ADC triggered while it converts"),
            Irregularity::StartedBySoftware => f.write_str("conversion started by software"),
            Irregularity::DmaOverrun { channel } => write!(f, "DMA channel {channel} overran"),
            Irregularity::ReceiverOverrun => f.write_str("USART receiver overran"),
            Irregularity::Fault { pc } => write!(f, "processor fault at {pc:#010x}"),
        }
    }
}

/// A pulse on PA1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pulse {
    /// Its rising edge.
    pub rise: Ticks,
    /// Its width.
    pub width: Ticks,
}

/// One conversion of the ADC.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Conversion {
    /// When sampling began.
    pub start: Ticks,
    /// When the input was held: the end of sampling.
    pub held: Ticks,
    /// The result.
    pub code: u16,
}

/// The cause of a reset.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ResetReason {
    /// The supply came up, or came back.
    PowerOn,
    /// The independent watchdog.
    Watchdog,
    /// A request by the program.
    Software,
}

/// A line of the program's log.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LogLine {
    /// The time at which it was read from the log's memory.
    pub at: Ticks,
    /// Level and text.
    pub text: String,
}

impl fmt::Display for LogLine {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{:.6} s: {}",
            to_duration(self.at).as_secs_f64(),
            self.text
        )
    }
}

/// The record since the board was switched on.
#[derive(Debug, Default)]
pub struct Record {
    /// Whether pulses and conversions are kept. Those of a board that runs for days would fill the memory.
    pub keeps_signals: bool,
    /// The irregularities.
    pub violations: Vec<Violation>,
    /// Pulses on PA1, complete ones only.
    pub pulses: Vec<Pulse>,
    /// Conversions of the ADC.
    pub conversions: Vec<Conversion>,
    /// Resets; the first one is the switching on.
    pub resets: Vec<(Ticks, ResetReason)>,
    /// The program's log.
    pub log: Vec<LogLine>,
}

/// Largest number of irregularities that are kept: one in a loop must not fill the memory.
const MOST_VIOLATIONS: usize = 1_000;

impl Record {
    pub(crate) fn violation(&mut self, at: Ticks, what: Irregularity) {
        if self.violations.len() < MOST_VIOLATIONS {
            self.violations.push(Violation { at, what });
        }
    }

    pub(crate) fn pulse(&mut self, pulse: Pulse) {
        if self.keeps_signals {
            self.pulses.push(pulse);
        }
    }

    pub(crate) fn conversion(&mut self, conversion: Conversion) {
        if self.keeps_signals {
            self.conversions.push(conversion);
        }
    }
}
