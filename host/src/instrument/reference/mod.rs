//! What a user asks a reference for, in degrees, seconds and Hertz, and the reference that it becomes,
//! in microseconds and frames.

mod in_words;
mod kind;
mod resolve;
mod steps_file;

pub use in_words::in_words;
pub use kind::{Band, Kind};
pub use resolve::{AMPLITUDE_DEG, ReferenceError, ReferenceSpec, ResolvedReference};
pub use steps_file::COLUMNS;

use servoid_protocol::timing::FRAME_US;

/// The time that so many frames take (s).
#[must_use]
pub fn seconds(frames: u32) -> f64 {
    // One rounding: 0.3 s stays 0.3.
    f64::from(frames) / (1e6 / f64::from(FRAME_US))
}

#[cfg(test)]
mod tests;
