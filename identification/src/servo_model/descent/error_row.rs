//! The error of the simulation at one sample, and its derivatives.

use super::step::MOST;

/// One sample: its error and the derivatives of the output.
#[derive(Clone)]
pub(crate) struct Row {
    /// Measured less simulated output, NaN where missing.
    pub(crate) error: f64,
    /// By each coordinate.
    pub(crate) slope: [f64; MOST],
    /// By the zero of the sensor.
    pub(crate) by_zero: f64,
}
