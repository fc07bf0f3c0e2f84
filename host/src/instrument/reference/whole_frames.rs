//! Times in whole frames, and the limits of every reference.

use super::error::ReferenceError;
use servoid_protocol::timing::{FRAME_US, FRAMES_PER_SECOND};

/// The board allows no pulse farther from neutral (µs).
pub(super) const LARGEST_AMPLITUDE_US: f64 = 1000.0;

/// The longest reference that leaves room for the rest around it within 16 bits of frames (s): 20 minutes.
pub(super) const LONGEST_S: f64 = 1200.0;

/// The time that so many frames take (s).
pub fn seconds(frames: u32) -> f64 {
    // One rounding: 0.3 s stays 0.3.
    f64::from(frames) / (1e6 / f64::from(FRAME_US))
}

/// The number of whole frames nearest to a time (s), at least one.
pub(super) fn frames(name: &str, time_s: f64) -> Result<u16, ReferenceError> {
    let frames = (time_s * f64::from(FRAMES_PER_SECOND)).round();
    if (1.0..=LONGEST_S * f64::from(FRAMES_PER_SECOND)).contains(&frames) {
        Ok(frames as u16)
    } else {
        Err(ReferenceError::OutOfRange(format!(
            "a {name} of {time_s} s is no number of frames of 20 ms: choose one from 0.02 to {LONGEST_S} s"
        )))
    }
}

/// The number of repetitions, at least one, that brings `once` nearest to `length`.
pub(super) fn repetitions(length: u32, once: u32) -> u32 {
    let twice = (2 * length).checked_div(once).unwrap_or(0);
    (twice / 2 + twice % 2).max(1)
}
