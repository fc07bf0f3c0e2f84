//! The common time base.
//!
//! One PWM frame is the unit of time on the wire: its pulse is constant within it, and it carries a
//! fixed number of samples. Sample `j` of frame `f` is taken `f·20 ms + phase + j·2 ms` after the
//! first rising edge; [`Hello`](crate::Hello) gives the phase.

/// Length of a PWM frame (µs): the usual frame of R/C servos, and the paper's (§4).
pub const FRAME_US: u32 = 20_000;

/// Time between two samples (µs) (paper §4: 2 ms).
pub const SAMPLE_US: u32 = 2_000;

/// Samples in one frame.
pub const SAMPLES_PER_FRAME: usize = (FRAME_US / SAMPLE_US) as usize;

/// Frames in one second.
pub const FRAMES_PER_SECOND: u32 = 1_000_000 / FRAME_US;

/// Half the frame rate (mHz), the highest frequency of a reference: it changes once per frame.
pub const HIGHEST_MILLIHERTZ: u16 = (FRAMES_PER_SECOND * 1_000 / 2) as u16;

// If a frame were not a whole number of samples, the samples would drift through the frame.
const _: () = assert!(FRAME_US.is_multiple_of(SAMPLE_US));
const _: () = assert!(1_000_000u32.is_multiple_of(FRAME_US));
