//! A measured value and how far it may be off.

use serde::Serialize;

/// A value with its interval at [`LEVEL`](super::sensor_scale::LEVEL).
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
