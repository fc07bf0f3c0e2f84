//! Times in whole frames, and the limits of every reference.

use super::error::ReferenceError;
use servoid_protocol::PulseTrain;

/// The board allows no pulse farther from neutral (µs).
pub(super) const LARGEST_AMPLITUDE_US: f64 = 1000.0;

/// The longest reference that leaves room for the rest around it within 16 bits of frames (s): 20 minutes.
pub(super) const LONGEST_S: f64 = 1200.0;

/// The time that so many frames of this train take (s).
pub fn seconds(frames: u32, train: PulseTrain) -> f64 {
    // One rounding: 0.3 s stays 0.3.
    f64::from(frames) * f64::from(train.frame_us()) / 1e6
}

/// The number of whole frames nearest to a time (s), at least one.
pub(super) fn frames(name: &str, time_s: f64, train: PulseTrain) -> Result<u16, ReferenceError> {
    let per_second = 1e6 / f64::from(train.frame_us());
    let frames = (time_s * per_second).round();
    // 16 bits number the frames of a run, and the rest around the reference takes some.
    let most = (LONGEST_S * per_second).min(f64::from(MOST_FRAMES));
    if (1.0..=most).contains(&frames) {
        Ok(frames as u16)
    } else {
        Err(ReferenceError::OutOfRange(format!(
            "a {name} of {time_s} s is no number of frames of {} ms: choose one from {} to {} s",
            f64::from(train.frame_us()) / 1e3,
            seconds(1, train),
            most.floor() / per_second
        )))
    }
}

/// A frame of this train, relative to that of the usual one: by so much a frequency is higher on the wire, which counts
/// in frames.
pub(super) fn frame_ratio(train: PulseTrain) -> f64 {
    train.frame_s() / PulseTrain::USUAL.frame_s()
}

/// Frames of the longest reference.
const MOST_FRAMES: u16 = 65_000;

/// The number of repetitions, at least one, that brings `once` nearest to `length`.
pub(super) fn repetitions(length: u32, once: u32) -> u32 {
    let twice = (2 * length).checked_div(once).unwrap_or(0);
    (twice / 2 + twice % 2).max(1)
}
