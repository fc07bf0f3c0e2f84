//! The choice of the order, and its intervals.

use faer::Mat;
use serde::{Deserialize, Serialize};

use super::levenberg_marquardt::Minimum;
use crate::numerics::matrix_rows::to_rows;
use crate::numerics::{chi_square_upper_tail, pointwise_critical};
use crate::results::{Bounds, Interval, ParameterBounds};
use crate::thresholds::{BARE_MENTION, ORDER_REJECTED};

/// One order, and how well it fits.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct OrderTried {
    /// Number of poles.
    pub order: usize,
    /// χ² of the lack of fit.
    pub chi_square: f64,
    /// Its degrees of freedom.
    pub degrees_of_freedom: usize,
    /// Probability of a χ² at least as large if the servo is of this order. In a band: that of this, or of errors as much like a slow end.
    pub p: f64,
    /// χ² + parameters · ln(rank).
    pub bic: f64,
    /// Largest difference of the step response from the identified one \[% of the step\], or of the frequency response in a band \[% of that at its lowest
    /// frequency\]; no error from the servo itself.
    pub largest_error_percent: f64,
}

impl OrderTried {
    /// The order's fit to `rank` independent values, with its largest error relative to the step.
    /// `None` when no degree of freedom is left.
    pub(super) fn new(order: usize, minimum: &Minimum, rank: usize, error: f64) -> Option<Self> {
        let count = minimum.parameters.len();
        let degrees_of_freedom = rank.checked_sub(count).filter(|degrees| *degrees > 0)?;
        Some(Self {
            order,
            chi_square: minimum.sum_of_squares,
            degrees_of_freedom,
            p: chi_square_upper_tail(minimum.sum_of_squares, degrees_of_freedom),
            bic: minimum.sum_of_squares + count as f64 * (rank as f64).ln(),
            largest_error_percent: 100.0 * error,
        })
    }

    /// The same, tested in another way with the probability `p`, too.
    pub(super) fn with_second_test(mut self, p: f64) -> Self {
        self.p = (2.0 * self.p.min(p)).min(1.0);
        self
    }

    pub(super) fn is_rejected(&self) -> bool {
        self.p < ORDER_REJECTED
    }
}

/// The fits, lowest order first, whose criterion is as good as the best one.
pub(super) fn simplest<T>(
    fits: &[T],
    tried: impl Fn(&T) -> OrderTried,
) -> impl Iterator<Item = &T> {
    let least = fits
        .iter()
        .map(|fit| tried(fit).bic)
        .fold(f64::INFINITY, f64::min);
    fits.iter()
        .filter(move |fit| tried(fit).bic <= least + BARE_MENTION)
}

/// The parameters of the chosen order with their intervals.
pub(super) struct Estimates<'a> {
    x: &'a [f64],
    /// Widened already.
    covariance: Mat<f64>,
    /// χ²/dof of a rejected order, 1 otherwise.
    pub(super) inflation: f64,
    level: Bounds<f64>,
}

impl<'a> Estimates<'a> {
    /// With standard deviations of the gain, and of all others, that are wider than those of even noise by these factors where no lack of fit widens them more.
    pub(super) fn new(
        minimum: &'a Minimum,
        tried: &OrderTried,
        level: Bounds<f64>,
        beyond_even_noise: [f64; 2],
    ) -> Self {
        let ratio = tried.chi_square / tried.degrees_of_freedom as f64;
        let inflation = match tried.is_rejected() {
            true => ratio.max(1.0),
            false => 1.0,
        };
        let of_fit = inflation.sqrt();
        let factor = |k: usize| beyond_even_noise[k.min(1)].max(of_fit);
        let count = minimum.parameters.len();
        let widened = |i: usize, k: usize| factor(i) * factor(k) * minimum.covariance[(i, k)];
        Self {
            x: &minimum.parameters,
            covariance: Mat::from_fn(count, count, widened),
            inflation,
            level,
        }
    }

    /// The interval of parameter `k`.
    pub(super) fn interval(&self, k: usize) -> Interval {
        let sd = self.covariance[(k, k)].max(0.0).sqrt();
        let half = self.level.map(|level| pointwise_critical(level) * sd);
        Interval::around(self.x[k], half.into_valid())
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
