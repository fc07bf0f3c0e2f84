//! Intervals of fitted parameters.

use faer::Mat;

use crate::numerics::critical_values::pointwise_critical;
use crate::results::metrics::Interval;
use crate::results::validity::Bounds;

/// Parameters with their covariance, and the level of their intervals, where these hold.
pub(super) struct Parameters<'a> {
    pub(super) values: &'a [f64],
    pub(super) covariance: &'a Mat<f64>,
    pub(super) level: Bounds<f64>,
}

impl Parameters<'_> {
    /// Of a parameter.
    pub(super) fn plain(&self, k: usize) -> Interval {
        let half =
            |level: &f64| pointwise_critical(*level) * self.covariance[(k, k)].max(0.0).sqrt();
        Interval::around(self.values[k], self.level.valid().map(half))
    }

    /// Of a quantity whose logarithm is a parameter.
    pub(super) fn exponential(&self, k: usize) -> Interval {
        self.plain(k).map(f64::exp)
    }
}
