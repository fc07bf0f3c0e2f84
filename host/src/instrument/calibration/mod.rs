//! The numbers of a rig file, measured: the sensor's scale, the servo's, and the ends of its travel.
//!
//! | file           | content                                                                               |
//! |----------------|---------------------------------------------------------------------------------------|
//! | `sensor_scale` | fits the sensor's scale to readings at known angles                                   |
//! | `measured`     | all that a calibration gives                                                           |
//! | `doubts`       | what that disagrees about with the rig file                                            |
//! | `mistyped_angle` | finds the one angle that does not belong to the others                          |
//! | `swapped_angles` | finds two angles that were given at each other's position                         |
//! | `mover`        | brings the servo to positions and reads the sensor there                              |
//! | `followed`     | finds positions to which the servo did not come                                       |
//! | `travel`       | neutral, gain and ends from a slow staircase over the pulses that the servo may be given |
//! | `rig_text`     | puts the results into a rig file                                                      |

mod doubts;
mod followed;
mod knee;
mod least_squares;
mod measured;
mod measured_value;
mod mistyped_angle;
mod mover;
mod rig_text;
mod sensor_scale;
mod swapped_angles;
mod travel;

pub use doubts::{doubts, moved_zero};
pub use followed::{NotFollowed, require_followed};
pub use measured::{DOUBT_PERCENT, Measured};
pub use measured_value::{Estimate, LEVEL};
pub use mistyped_angle::{MistypedAngle, mistyped_angle};
pub use mover::{MoveError, Mover, Rest};
pub use rig_text::{Found, put_into};
pub use sensor_scale::{Calibration, CalibrationError, Reading};
pub use swapped_angles::{SwappedAngles, swapped_angles};
pub use travel::{End, Travel, TravelError};

#[cfg(test)]
mod tests;
