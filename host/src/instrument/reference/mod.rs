//! References as a user specifies them, in degrees, seconds and Hertz, and as the board plays them, in
//! microseconds and frames.

mod description;
mod error;
mod kind;
mod resolve;
mod steps_file;
mod whole_frames;

pub use description::describe;
pub use error::ReferenceError;
pub use kind::{FrequencyBand, Kind};
pub use resolve::{AMPLITUDE_DEG, ReferenceSpec, ResolvedReference};
pub use steps_file::COLUMNS;
pub use whole_frames::seconds;

#[cfg(test)]
mod tests;
