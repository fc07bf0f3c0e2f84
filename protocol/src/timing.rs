//! The common time base.
//!
//! One frame is the unit of time on the wire: its pulses have one width, and it carries ten samples. Sample `j` of frame
//! `f` is taken `f · frame + phase + j · frame/10` after the first rising edge. The
//! [train of pulses](crate::pulse_train) gives the length of a frame and the phase, and [`Hello`](crate::Hello) states both.
//!
//! The constants of a length are those of the usual train, one pulse in 20 ms.

use crate::pulse_train::PulseTrain;

pub use crate::pulse_train::SAMPLES_PER_FRAME;

/// Length of a frame of the usual train (µs): the usual frame of R/C servos, and the paper's (§4).
pub const FRAME_US: u32 = PulseTrain::USUAL.frame_us();

/// Time between two samples of the usual train (µs) (paper §4: 2 ms).
pub const SAMPLE_US: u32 = PulseTrain::USUAL.sample_us() as u32;

/// Frames of the usual train in one second.
pub const FRAMES_PER_SECOND: u32 = 1_000_000 / FRAME_US;

/// Half the frame rate of the usual train (mHz), the highest frequency of a reference: it changes once per frame.
pub const HIGHEST_MILLIHERTZ: u16 = (FRAMES_PER_SECOND * 1_000 / 2) as u16;

// If a frame were not a whole number of samples, the samples would drift through the frame.
const _: () = assert!(FRAME_US == SAMPLE_US * SAMPLES_PER_FRAME as u32);
const _: () = assert!(1_000_000u32.is_multiple_of(FRAME_US));
