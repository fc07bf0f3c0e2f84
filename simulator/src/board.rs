//! A board without hardware, for the firmware's own library.

use crate::apparatus::{Apparatus, SimulatedFrame};
use crate::options::{OptionsError, SimulationOptions};
use crate::sensor::{FULL_SCALE, OVERSAMPLING};
use servoid_firmware::{Board, CapturedFrame, ChipIdentity, FrameTiming, Identity, Supply};
use servoid_protocol::hello::{ClockSource, ResetCause, Text16};
use servoid_protocol::{PulseTrain, PulseWidth};
use std::cell::Cell;
use std::future::poll_fn;
use std::rc::Rc;
use std::task::Poll;

/// Frames so far, shared by a board and its driver.
pub type FrameClock = Rc<Cell<u64>>;

/// The train of the present frame, shared in the same way: it says when the frame ends.
pub type TrainInUse = Rc<Cell<PulseTrain>>;

/// Gets each frame as it is sampled.
pub type Observer = Box<dyn FnMut(&SimulatedFrame)>;

/// A [`Board`] over an [`Apparatus`].
///
/// [`Board::next_frame`] is pending until the [`FrameClock`] counts one more frame. It wakes no task: the driver
/// of the clock also polls.
pub struct SimulatedBoard {
    apparatus: Apparatus,
    clock: FrameClock,
    observer: Observer,
    /// Frames that the rig has taken.
    taken: u64,
    /// The train of the present frame.
    train: TrainInUse,
    asked_train: PulseTrain,
    /// The pulse from the next frame edge on.
    pulse: Option<PulseWidth>,
    identity: Identity,
}

impl SimulatedBoard {
    /// The train of the present frame, for the driver of the clock.
    pub fn train_in_use(&self) -> TrainInUse {
        self.train.clone()
    }

    /// A board that was just switched on. `observer` gets every frame, with its true angles.
    pub fn new(
        options: &SimulationOptions,
        clock: FrameClock,
        observer: Observer,
    ) -> Result<Self, OptionsError> {
        Ok(Self {
            apparatus: Apparatus::new(options)?,
            clock,
            observer,
            taken: 0,
            train: TrainInUse::default(),
            asked_train: PulseTrain::USUAL,
            pulse: None,
            identity: identity(options),
        })
    }
}

fn identity(options: &SimulationOptions) -> Identity {
    // A board and its sensor are one: the seed is of a run.
    let mut unique_id = *b"sim.        ";
    unique_id[4..].copy_from_slice(&options.conditions.sensor_gain.to_le_bytes());
    let board = ["sim:", options.servo.name()].concat();
    Identity {
        board: Text16::new(&board),
        unique_id,
        clock: ClockSource::Simulated,
        reset_cause: ResetCause::PowerOn,
        first_sample_us: options.first_sample_us,
        // All conversions of a sample see the angle of one instant.
        aperture_us: 0,
        oversampling: OVERSAMPLING as u8,
        full_scale: FULL_SCALE,
        chip: ChipIdentity::default(),
        last_fault: None,
    }
}

impl Board for SimulatedBoard {
    fn identity(&self) -> Identity {
        self.identity
    }

    async fn next_frame(&mut self) -> CapturedFrame {
        poll_fn(|_| match self.clock.get() {
            frames if self.taken < frames => Poll::Ready(()),
            _ => Poll::Pending,
        })
        .await;
        // No await from here on, so a dropped future has not taken the frame.
        self.taken += 1;
        let frame = self.apparatus.frame_of(self.train.get(), self.pulse);
        (self.observer)(&frame);
        CapturedFrame {
            number: frame.number as u32, // wraps, as the trait allows
            train: frame.train,
            pulse: frame.pulse,
            samples: frame.samples,
            supply: Supply::default(),
            timing: FrameTiming::default(),
        }
    }

    fn set_train(&mut self, train: PulseTrain) {
        self.asked_train = train;
    }

    fn set_pulse(&mut self, pulse: Option<PulseWidth>) {
        // The frame before this call is over; one without a pulse follows, or none.
        if self.pulse.is_none() && pulse.is_none() {
            self.train.set(self.asked_train);
        }
        self.pulse = pulse;
    }

    /// Does nothing: a rig that hangs also hangs its caller.
    fn feed_watchdog(&mut self) {}

    /// Does nothing: a simulated board has no LED.
    fn show_armed(&mut self, _armed: bool) {}
}
