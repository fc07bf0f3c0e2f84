//! The error of the simulation at one sample, and its derivatives.

use super::descent_step::MOST;

/// One sample: its error and the derivatives of the output.
#[derive(Clone)]
pub(super) struct Row {
    /// Measured less simulated output, NaN where missing.
    pub(super) error: f64,
    /// By each coordinate.
    pub(super) slope: [f64; MOST],
    /// By the zero of the sensor.
    pub(super) by_zero: f64,
}
