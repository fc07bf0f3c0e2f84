//! How the parameters of an order differ from run to run, where the response is known in a band alone.
//!
//! Each run has parameters of its own there, as it has a response of its own. Those x of R runs together have the covariance
//!
//! ```text
//! sum_r d_r d_r' / (R (R - 1)),    d_r = x_r - mean of x
//! ```
//!
//! at R - 1 degrees of freedom, beside that of the noise.

use faer::Mat;

use super::fitter::{FittedOrder, Fitter};
use crate::numerics::student_critical;

/// How runs differ.
pub(super) enum RunsApart {
    /// There are none, or bounds have it already.
    None,
    /// Covariance of the parameters of all runs together, and its degrees of freedom.
    Known(Mat<f64>, f64),
    /// A run by itself has no such order.
    Unknown,
}

impl RunsApart {
    /// In parameters of the order that was `chosen`.
    pub(super) fn of(runs: &[Fitter], chosen: &FittedOrder) -> Self {
        if runs.is_empty() {
            return Self::None;
        }
        let own = |run: &Fitter| run.best(chosen.order, &[chosen.transfer]);
        let all: Option<Vec<FittedOrder>> = runs.iter().map(own).collect();
        let Some(all) = all else {
            return Self::Unknown;
        };
        let (count, degrees) = (all.len() as f64, all.len() as f64 - 1.0);
        let size = chosen.minimum.parameters.len();
        let of = |run: &FittedOrder, k: usize| run.minimum.parameters[k];
        let mean: Vec<f64> = (0..size)
            .map(|k| all.iter().map(|run| of(run, k)).sum::<f64>() / count)
            .collect();
        let product = |i: usize, k: usize| {
            let each = all
                .iter()
                .map(|run| (of(run, i) - mean[i]) * (of(run, k) - mean[k]));
            each.sum::<f64>() / (count * degrees)
        };
        Self::Known(Mat::from_fn(size, size, product), degrees)
    }

    /// The ends of the interval of parameter `k` around `x`, with this in them, where `critical` holds at endless degrees of freedom.
    pub(super) fn widened(
        &self,
        k: usize,
        x: f64,
        [lower, upper]: [f64; 2],
        critical: f64,
    ) -> Option<[f64; 2]> {
        match self {
            Self::None => Some([lower, upper]),
            Self::Unknown => None,
            Self::Known(covariance, degrees) => {
                let half = student_critical(critical, &[*degrees])[0] * covariance[(k, k)].sqrt();
                Some([x - (x - lower).hypot(half), x + (upper - x).hypot(half)])
            }
        }
    }

    /// What is added to a covariance.
    pub(super) fn covariance(&self, i: usize, k: usize) -> f64 {
        match self {
            Self::Known(covariance, _) => covariance[(i, k)],
            Self::None | Self::Unknown => 0.0,
        }
    }
}
