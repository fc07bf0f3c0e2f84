//! What a self-test has measured.

use serde::Serialize;
use servoid_protocol::loopback::Vitals;
use servoid_protocol::message::Status;
use servoid_protocol::{Health, Hello};

/// A pulse, by its edges at the sensor's pin.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct MeasuredPulse {
    /// As it was asked for (µs).
    pub asked_us: u16,
    /// From its rising to its falling edge (µs), within a microsecond; `None` where one of them was not found.
    pub width_us: Option<f64>,
}

/// Levels of the sensor's pin (share of the supply), and their standard deviations (counts of a sample).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Level {
    /// Its mean.
    pub share: f64,
    /// Standard deviation (counts).
    pub sd_counts: f64,
}

/// Why the board did not see its own pulses.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Unseen {
    /// The pin was not at zero before there was a pulse.
    NotLowBefore,
    /// The pin stayed at zero with pulses on.
    StayedLow,
    /// They were seen for a while.
    Lost,
}

/// What a self-test has measured.
#[derive(Clone, Debug, Serialize)]
pub struct MeasuredBoard {
    /// The identity of the board.
    pub hello: Hello,
    /// Its state before the test.
    pub status_before: Status,
    /// And after it.
    pub status_after: Status,
    /// Its chip, supply and last fault.
    pub health: Health,
    /// Its processor before frames were counted, with some fifty questions a second.
    pub vitals_before: Vitals,
    /// And after that.
    pub vitals_after: Vitals,
    /// And at the end of the test.
    pub vitals_at_end: Vitals,
    /// Least and largest length of a frame by this computer's clock (ms); `None` where it cannot be determined.
    pub frame_ms: Option<[f64; 2]>,
    /// The pin before the first pulse (share of the supply).
    pub pin_before: f64,
    /// Why no pulse was seen; `None` where all were.
    pub unseen: Option<Unseen>,
    /// The pulses.
    pub pulses: Vec<MeasuredPulse>,
    /// From the trigger of a probe to the moment at which it holds its input, by the rising edge (µs).
    pub probe_holds_us: Option<f64>,
    /// The least time after a frame's edge at which the processor had its last sample (µs).
    pub sampled_us: Option<u16>,
    /// The pin while the line is high.
    pub high: Option<Level>,
    /// The pin while the line is low.
    pub low: Option<Level>,
    /// Requests to the board.
    pub requests: u32,
    /// Of these, sent again because no answer came in time.
    pub requests_repeated: u32,
    /// Messages of the board that could not be read.
    pub unreadable: u32,
}

impl MeasuredBoard {
    /// The chip's supply (V), by its reference voltage of 1.20 V; 1.16 to 1.24 V from chip to chip (data sheet DS5319).
    pub fn supply_volts(&self) -> Option<f64> {
        const REFERENCE_VOLTS: f64 = 1.20;
        let full_scale = 4_095.0 * f64::from(servoid_protocol::health::BANDGAP_CONVERSIONS);
        let bandgap = f64::from(self.health.bandgap);
        (self.health.bandgap != 0).then(|| REFERENCE_VOLTS * full_scale / bandgap)
    }

    /// Share of the time in which the processor was awake (%).
    pub fn load_percent(&self) -> Option<f64> {
        let (before, after) = (&self.vitals_before, &self.vitals_after);
        let frames = after.frames.wrapping_sub(before.frames);
        let awake_us = after.awake_us.wrapping_sub(before.awake_us);
        let passed_us = f64::from(frames) * f64::from(self.hello.frame_us);
        let measures = after.stack_bytes > 0 && frames > 0;
        measures.then(|| 100.0 * f64::from(awake_us) / passed_us)
    }

    /// From the trigger of a probe to the moment at which it holds its input (µs), by the aperture that the board states: 239.5 of
    /// the 252 cycles of a conversion (RM0008, 11.6), and two to three of latency (data sheet DS5319).
    pub fn stated_hold_us(&self) -> f64 {
        let conversion_us =
            f64::from(self.hello.aperture_us) / f64::from(self.hello.oversampling.max(1));
        conversion_us * (239.5 + 2.5) / 252.0
    }

    /// From a pulse's rising edge to the first sample (µs), the processor's delay included.
    pub fn first_sample_us(&self) -> Option<f64> {
        let hello = &self.hello;
        let later = f64::from(hello.frame_us) - f64::from(hello.sample_us);
        let takes = f64::from(hello.aperture_us);
        Some(f64::from(self.sampled_us?) - later - takes)
    }
}
