//! The hardware that a rig needs: a board and a link.

use servoid_protocol::health::LastFault;
use servoid_protocol::hello::{ClockSource, ResetCause, Text16};
use servoid_protocol::loopback::{Probe, Vitals};
use servoid_protocol::timing::SAMPLES_PER_FRAME;
use servoid_protocol::{Counts, PulseTrain, PulseWidth};

/// The identity of a board; goes into [`Hello`](servoid_protocol::Hello).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Identity {
    /// The kind of board.
    pub board: Text16,
    /// Its unique number.
    pub unique_id: [u8; 12],
    /// The source of its clock.
    pub clock: ClockSource,
    /// The cause of its last reset.
    pub reset_cause: ResetCause,
    /// From a pulse's rising edge to the start of the frame's first sample (µs), with the usual train of pulses.
    pub first_sample_us: u16,
    /// From the start of a sample's first conversion to the end of its last one (µs).
    pub aperture_us: u16,
    /// Conversions summed into one sample.
    pub oversampling: u8,
    /// Counts of a sensor at the supply rail.
    pub full_scale: Counts,
    /// The chip.
    pub chip: ChipIdentity,
    /// The fault that led to the last start, if one did.
    pub last_fault: Option<LastFault>,
}

/// What a chip says of itself.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ChipIdentity {
    /// Its flash (KiB); 0 where it is not known.
    pub flash_kib: u16,
    /// Its device and revision code; 0 where it hides it.
    pub device: u32,
}

/// One frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CapturedFrame {
    /// Frames since the board started, wrapping. A step of more than one means that the board lost frames.
    pub number: u32,
    /// The train whose frame this is, though there may be no pulse in it.
    pub train: PulseTrain,
    /// The pulses on the line in this frame; `None` without any.
    pub pulse: Option<PulseWidth>,
    /// The samples taken in this frame, in order.
    pub samples: [Counts; SAMPLES_PER_FRAME],
    /// The board's own supply in this frame.
    pub supply: Supply,
    /// What the board saw of its own timing.
    pub timing: FrameTiming,
}

/// What a board saw of its own timing in a frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FrameTiming {
    /// When the processor had the frame's last sample (µs after the frame edge).
    pub sampled_us: u16,
    /// The newest probe, if one was asked for.
    pub probe: Option<Probe>,
}

/// The board's own supply in a frame. The readings of the converter are relative to it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Supply {
    /// Reading of the internal reference voltage (counts of one conversion); 0 where it is not measured.
    pub bandgap: u16,
    /// Whether it was too low for exact readings at any moment.
    pub is_low: bool,
}

impl CapturedFrame {
    /// Number of frames that the board lost between frame `before` and this one.
    pub fn lost_since(&self, before: u32) -> u32 {
        self.number.wrapping_sub(before).saturating_sub(1)
    }
}

/// A board: pulses out, samples in, both on one clock.
///
/// Only the board keeps time. Pulses change at frame edges only, samples are taken at fixed phases of the frame, and
/// the rig counts frames instead of reading a clock.
#[allow(async_fn_in_trait)] // one executor, one thread: the futures need not be `Send`
pub trait Board {
    /// The identity of the board.
    fn identity(&self) -> Identity;

    /// Waits until the next frame has been sampled. The pulse set between two calls applies from
    /// the next frame edge on; [`CapturedFrame::pulse`] is the pulse that was really applied.
    ///
    /// Dropping the future before it is ready loses nothing.
    async fn next_frame(&mut self) -> CapturedFrame;

    /// The train of pulses from now on. A board follows at the end of a frame that has no pulse on the line and none
    /// prepared for the next one; [`CapturedFrame::train`] says when it has.
    fn set_train(&mut self, train: PulseTrain);

    /// The pulses from the next frame edge on; `None` for none.
    fn set_pulse(&mut self, pulse: Option<PulseWidth>);

    /// Takes one more conversion in each frame from now on, at this instant (µs after the frame edge), for a self-test. It
    /// takes the place of the reference voltage's. A board that cannot do it leaves it.
    fn set_probe(&mut self, _at_us: Option<u16>) {}

    /// What the board measures of its own processor; zeros where it does not.
    fn vitals(&mut self) -> Vitals {
        Vitals::default()
    }

    /// Feeds the watchdog. Called once for each captured frame.
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

    /// Takes all of `bytes` for sending and returns `true`, or takes none if there is no room.
    fn try_send(&mut self, bytes: &[u8]) -> bool;
}
