//! What a rig file says, measured: the sensor's scale, the servo's, and the ends of its travel.
//!
//! [`sensor_scale`] fits the sensor's scale to readings at known angles; [`mover`] brings the servo to
//! positions and reads the sensor there; [`require_followed`] tells positions to which it did not come;
//! [`travel`] tells from a slow staircase over the pulses that the servo may be given where neutral is, how far
//! a microsecond turns it, and where it ends; [`rig_text`] puts what was found into a rig file.

mod estimate;
mod followed;
mod knee;
mod least_squares;
mod mover;
mod rig_text;
mod sensor_scale;
mod travel;

pub use estimate::Estimate;
pub use followed::{NotFollowed, require_followed};
pub use mover::{MoveError, Mover, Rest};
pub use rig_text::{Found, put_into};
pub use sensor_scale::{Calibration, CalibrationError, LEVEL, Reading};
pub use travel::{End, Travel, TravelError};

#[cfg(test)]
mod tests;
