//! A measured value and how far it may be off.

use serde::Serialize;
use servoid_identification::results::{pointwise_critical, student_critical};

/// Confidence of the intervals.
pub const LEVEL: f64 = 0.99;

/// Student's t for [`LEVEL`] with so many degrees of freedom.
pub(super) fn student(degrees_of_freedom: f64) -> f64 {
    let t = student_critical(pointwise_critical(LEVEL), &[degrees_of_freedom]);
    t.first().copied().unwrap_or(f64::INFINITY)
}

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
    pub fn around(value: f64, half: f64) -> Self {
        Self {
            value,
            lower: value - half,
            upper: value + half,
        }
    }
}
