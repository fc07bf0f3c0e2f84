//! What the rig needs from the hardware below it.

use servoid_protocol::hello::{ClockSource, ResetCause, Text16};
use servoid_protocol::timing::SAMPLES_PER_FRAME;
use servoid_protocol::{Counts, PulseWidth};

/// What a board says of itself; goes into [`Hello`](servoid_protocol::Hello).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Identity {
    /// The kind of board.
    pub board: Text16,
    /// Its unique number.
    pub unique_id: [u8; 12],
    /// Where its clock comes from.
    pub clock: ClockSource,
    /// Why it last started.
    pub reset_cause: ResetCause,
    /// From a pulse's rising edge to the start of the frame's first sample (µs).
    pub first_sample_us: u16,
    /// From the start of a sample's first conversion to the end of its last one (µs).
    pub aperture_us: u16,
    /// Conversions summed into one sample.
    pub oversampling: u8,
    /// Counts of a sensor at the supply rail.
    pub full_scale: Counts,
}

/// What one PWM frame brought.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CapturedFrame {
    /// PWM frames since the board started, wrapping. A number that is more than one above the last
    /// one says that frames were lost on the board.
    pub number: u32,
    /// The pulse that was on the line in this frame; `None` when there was none.
    pub pulse: Option<PulseWidth>,
    /// The samples taken in this frame, in order.
    pub samples: [Counts; SAMPLES_PER_FRAME],
}

impl CapturedFrame {
    /// How many frames the board failed to catch between frame `before` and this one.
    #[must_use]
    pub fn lost_since(&self, before: u32) -> u32 {
        self.number.wrapping_sub(before).saturating_sub(1)
    }
}

/// A board: pulses out, samples in, both on one clock.
///
/// The board alone keeps time. Pulses change at frame edges only, samples come at fixed phases of
/// the frame, and the rig never looks at a clock: it counts frames.
#[allow(async_fn_in_trait)] // one executor, one thread: the futures need not be `Send`
pub trait Board {
    /// What the board says of itself.
    fn identity(&self) -> Identity;

    /// Waits until the next frame has been sampled. The pulse set between two calls applies from
    /// the next frame edge on; the board reports in [`CapturedFrame::pulse`] what really was.
    ///
    /// Dropping the future before it is ready loses nothing.
    async fn next_frame(&mut self) -> CapturedFrame;

    /// The pulse from the next frame edge on; `None` for no pulse.
    fn set_pulse(&mut self, pulse: Option<PulseWidth>);

    /// Tells the watchdog that the rig is alive. Called once per frame that really came.
    fn feed_watchdog(&mut self);

    /// Shows whether pulses are on, for a person beside the board.
    fn show_armed(&mut self, armed: bool);
}

/// A byte link to the host. Neither direction ever blocks the rig.
#[allow(async_fn_in_trait)] // see `Board`
pub trait Link {
    /// Waits for bytes from the host and copies them to `buffer`; returns how many (at least one).
    ///
    /// Dropping the future before it is ready loses nothing.
    async fn receive(&mut self, buffer: &mut [u8]) -> usize;

    /// Takes all of `bytes` for sending, or none of it and returns `false` while there is no room.
    fn try_send(&mut self, bytes: &[u8]) -> bool;
}
