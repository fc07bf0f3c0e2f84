//! The record of a board: pulses, conversions, resets, irregularities and log lines.

use crate::time::{Ticks, to_duration};
use std::fmt;
use thiserror::Error;

/// A violation of the manual by the program, or its use of a function that is not modelled. Every model reports both,
/// so nothing passes in silence.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum Irregularity {
    /// An access to an unmapped address.
    #[error("nothing is at {0:#010x}")]
    Unmapped(u32),
    /// An access to a peripheral whose clock is off (RM0008 7.3.6-7.3.8).
    #[error("{0:#010x} accessed without a clock")]
    Unclocked(u32),
    /// An access to less than a whole register, where only whole ones may be accessed.
    #[error("{0:#010x} accessed by less than its register")]
    Narrow(u32),
    /// A function of the chip that is not modelled.
    #[error("not modelled: {0}")]
    NotModelled(&'static str),
    /// Against a rule of the reference manual.
    #[error("against RM0008: {0}")]
    AgainstTheManual(&'static str),
    /// A trigger came while the ADC was converting: a sample is missing.
    #[error("ADC triggered while it converts")]
    TriggerWhileBusy,
    /// A conversion that was started by software (RM0008 11.12.3): it is not on the grid.
    #[error("conversion started by software")]
    StartedBySoftware,
    /// The DMA channel completed a half of its ring before the program had acknowledged the one before.
    #[error("DMA channel {0} overran")]
    DmaOverrun(u8),
    /// The receiver had no room for a byte (RM0008 27.6.1, ORE).
    #[error("USART receiver overran")]
    ReceiverOverrun,
    /// The processor met a fault at this program counter.
    #[error("processor fault at {0:#010x}")]
    Fault(u32),
}

/// An [`Irregularity`] with its time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[error("{:.6} s: {what}", to_duration(*.at).as_secs_f64())]
pub struct Violation {
    /// Its time.
    pub at: Ticks,
    /// The irregularity.
    pub what: Irregularity,
}

/// A pulse on PA1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pulse {
    /// Its rising edge.
    pub rise: Ticks,
    /// Its width.
    pub width: Ticks,
}

/// A time in which nothing on the board drove PA1: only the pull-down resistor beside it held it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Undriven {
    /// Its beginning.
    pub from: Ticks,
    /// Its end, unless it lasts.
    pub to: Option<Ticks>,
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
    /// The reset pin.
    Pin,
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
        let seconds = to_duration(self.at).as_secs_f64();
        write!(f, "{seconds:.6} s: {}", self.text)
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
    /// Times in which PA1 was not driven.
    pub undriven: Vec<Undriven>,
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
