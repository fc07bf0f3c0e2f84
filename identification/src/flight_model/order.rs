//! The choice of the order.

use serde::{Deserialize, Serialize};

use super::levenberg_marquardt::Minimum;
use crate::numerics::chi_square_upper_tail;
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

    /// χ² over its degrees of freedom of an order that is rejected; 1 of others.
    pub(super) fn lack_of_fit(&self) -> f64 {
        match self.is_rejected() {
            true => (self.chi_square / self.degrees_of_freedom as f64).max(1.0),
            false => 1.0,
        }
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
