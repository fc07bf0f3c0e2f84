//! The self-test of a board: its pulse line is wired to its sensor's pin, so it sees its own pulses.
//!
//! The frames of a run are sampled at fixed instants, none of which falls on an edge. A *probe* is one more conversion, at an
//! instant of the host's choice: from which instant on it reads low is where the pulse ends.

use crate::timing::SAMPLES_PER_FRAME;
use crate::units::{Counts, PulseWidth};
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// Instants of probes that see where a pulse ends (µs after the frame edge): between the first two samples.
pub const PROBES_AFTER_EDGE: core::ops::RangeInclusive<u16> = 600..=2_460;

/// Instants of probes that see where a pulse begins: between the last sample of a frame and its end. They hold their input
/// up to 20 µs later, in the next frame.
pub const PROBES_BEFORE_EDGE: core::ops::RangeInclusive<u16> = 18_700..=19_999;

/// What a board in its self-test is to do.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Loopback {
    /// The host's [`SCHEMA_HASH`](crate::schema::SCHEMA_HASH).
    pub schema_hash: u64,
    /// The width of all pulses, within the limits of the board.
    pub pulse: PulseWidth,
    /// The instant of the probe in each frame: in [`PROBES_AFTER_EDGE`] or [`PROBES_BEFORE_EDGE`].
    pub probe_us: u16,
}

/// A conversion of the sensor's pin at an instant of the host's choice.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Probe {
    /// Its trigger (µs after the frame edge).
    pub at_us: u16,
    /// Its result (counts of one conversion).
    pub code: u16,
}

/// The newest frame of a board in its self-test.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct LoopbackFrame {
    /// Its number, since the start.
    pub number: u32,
    /// The pulse on the line in it.
    pub pulse: Option<PulseWidth>,
    /// Its samples, in order.
    pub samples: [Counts; SAMPLES_PER_FRAME],
    /// When the processor had its last sample (µs after the frame edge).
    pub sampled_us: u16,
    /// The newest probe; `None` for three frames after its instant was changed.
    pub probe: Option<Probe>,
}

/// What a board measures of its own processor.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Vitals {
    /// PWM frames since the start.
    pub frames: u32,
    /// Time for which the processor was awake since the start, interrupts included (µs, wrapping).
    pub awake_us: u32,
    /// Room for the stack (bytes); 0 where the board does not measure.
    pub stack_bytes: u16,
    /// Of these, never used since the start (bytes).
    pub stack_unused: u16,
}
