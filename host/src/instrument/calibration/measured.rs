//! The result of a calibration.

use super::mover::Rest;
use super::sensor_scale::{Calibration, Reading};
use super::travel::Travel;
use serde::Serialize;

/// The result as `--json` prints it.
#[derive(Serialize)]
pub struct Measured {
    /// The sensor's scale; `None` where it was not measured.
    pub sensor: Option<Calibration>,
    /// Whether its angles are assumed: those that the pulses command.
    pub assumed: bool,
    /// Its readings.
    pub readings: Vec<Reading>,
    /// The sensor at each position, where a rig measured it.
    pub rests: Vec<Rest>,
    /// The servo's scale and the ends of its travel, where a rig measured them.
    pub travel: Option<Travel>,
    /// What it disagrees about with the rig file, a sentence each.
    pub doubts: Vec<String>,
    /// That its zero is not that of the calibration before, where that is so.
    pub moved_zero: Option<String>,
}

/// Standard deviation of a data sheet's microseconds per degree (percent): makers round, and servos of one type
/// differ by some percent.
pub const DOUBT_PERCENT: f64 = 5.0;
