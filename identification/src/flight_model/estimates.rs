//! The parameters of an order with their intervals and their covariance.

use faer::Mat;

use super::intervals::Ends;
use super::levenberg_marquardt::Minimum;
use crate::numerics::matrix_rows::to_rows;
use crate::results::{Bounds, Interval, ParameterBounds};

/// The parameters of the chosen order with their intervals.
pub(super) struct Estimates<'a> {
    x: &'a [f64],
    /// Of each parameter, where bounds hold.
    ends: Bounds<Ends>,
    level: Bounds<f64>,
    covariance: Mat<f64>,
}

impl<'a> Estimates<'a> {
    /// Of a minimum, whose `covariance` is not that of even noise alone.
    pub(super) fn new(
        minimum: &'a Minimum,
        level: Bounds<f64>,
        ends: Bounds<Ends>,
        covariance: Mat<f64>,
    ) -> Self {
        Self {
            x: &minimum.parameters,
            ends,
            level,
            covariance,
        }
    }

    /// The interval of parameter `k`.
    pub(super) fn interval(&self, k: usize) -> Interval {
        let ends = self.ends.valid().and_then(|ends| ends[k]);
        let [lower, upper] = ends.unwrap_or([f64::NAN; 2]);
        Interval::new(self.x[k], lower, upper)
    }

    /// The interval of the quantity whose logarithm is parameter `k`.
    pub(super) fn exponential(&self, k: usize) -> Interval {
        self.interval(k).map(f64::exp)
    }

    /// Level and covariance, where bounds hold.
    pub(super) fn bounds(&self) -> Bounds<ParameterBounds> {
        self.level.map(|level| ParameterBounds {
            level,
            covariance: to_rows(&self.covariance),
        })
    }
}
