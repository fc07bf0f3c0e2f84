//! The clock that everything shares.
//!
//! One PWM frame is the unit of time on the wire: its pulse is constant within it, and it carries a
//! fixed number of samples. Sample `j` of frame `f` is taken `f·20 ms + phase + j·2 ms` after the
//! first rising edge, where the phase is stated in [`Hello`](crate::Hello).

/// Length of a PWM frame (µs): the usual frame of R/C servos, and the paper's (§4).
pub const FRAME_US: u32 = 20_000;

/// Time between two samples (µs) (paper §4: 2 ms).
pub const SAMPLE_US: u32 = 2_000;

/// Samples in one frame.
pub const SAMPLES_PER_FRAME: usize = (FRAME_US / SAMPLE_US) as usize;

/// Frames in one second.
pub const FRAMES_PER_SECOND: u32 = 1_000_000 / FRAME_US;

// A frame that is not a whole number of samples would let the samples wander through the frame.
const _: () = assert!(FRAME_US.is_multiple_of(SAMPLE_US));
const _: () = assert!(1_000_000u32.is_multiple_of(FRAME_US));
