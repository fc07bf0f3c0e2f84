//! What a rig file says, measured: the sensor's scale, the servo's, and the ends of its travel.
//!
//! [`sensor`] fits the sensor's scale to readings at known angles; [`mover`] brings the servo to
//! positions and reads the sensor there; [`require_followed`] tells positions to which it did not come;
//! [`travel`] tells from a slow staircase over the pulses that the servo may be given where neutral is, how far
//! a microsecond turns it, and where it ends; [`rig_text`] puts what was found into a rig file.

mod followed;
mod knee;
mod least_squares;
pub mod mover;
pub mod rig_text;
pub mod sensor;
pub mod travel;

pub use followed::{NotFollowed, require_followed};
pub use mover::{MoveError, Mover, Rest};
pub use rig_text::{Found, put_into};
pub use sensor::{Calibration, CalibrationError, LEVEL, Reading};
pub use travel::{End, Travel, TravelError};

use serde::Serialize;

/// A value with its interval at [`LEVEL`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Estimate {
    /// The value.
    pub value: f64,
    /// The interval's lower end.
    pub lower: f64,
    /// Its upper end.
    pub upper: f64,
}

impl Estimate {
    /// `value` plus and minus `half`.
    #[must_use]
    pub fn around(value: f64, half: f64) -> Self {
        Self {
            value,
            lower: value - half,
            upper: value + half,
        }
    }

    /// Whether a number lies in the interval.
    #[must_use]
    pub fn covers(&self, number: f64) -> bool {
        (self.lower..=self.upper).contains(&number)
    }
}

#[cfg(test)]
mod tests;
