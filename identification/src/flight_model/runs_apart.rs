//! How the parameters of an order differ from run to run.
//!
//! Each run has parameters of its own, as it has a response of its own. Those x of R runs together have the covariance
//!
//! ```text
//! sum_r d_r d_r' / (R (R - 1)),    d_r = x_r - mean of x
//! ```
//!
//! at R - 1 degrees of freedom, beside that of the noise. A factor by which bounds of the step response are wider is not enough: an order takes its gain from all of the response,
//! which averages noise, and not the gains of the runs.
//!
//! Where nothing is known of single runs, as of a model without its record, the gain has all of what its bound at the end of the step response has beside even noise.

use super::fitter::{FittedOrder, Fitter};
use super::projection::Projection;
use crate::numerics::{SampleMean, student_critical};
use crate::results::Model;

/// What is known of single runs.
pub(super) enum Runs {
    /// They are too few to say how they differ.
    TooFew,
    /// What each shows by itself.
    Each(Vec<Projection>),
    /// Nothing, though there may be several.
    Unknown,
}

/// How runs differ.
pub(super) enum RunsApart {
    /// Further variance of the gain, 0 where bounds are those of these runs.
    OfGain(f64),
    /// The mean of the parameters of the runs.
    Known(SampleMean),
    /// A run by itself has no such order.
    Unknown,
}

impl RunsApart {
    /// In parameters of the order that was `chosen`, which was fitted to the projection of the model.
    pub(super) fn of(
        runs: Runs,
        chosen: &FittedOrder,
        (projection, model): (&Projection, &Model),
    ) -> Self {
        let of_run = |projection: Projection| {
            let timing = model.timing();
            let run = Fitter { projection, timing };
            let fit = run.best(chosen.order, &[chosen.transfer])?;
            Some(fit.minimum.parameters)
        };
        match runs {
            Runs::TooFew => Self::OfGain(0.0),
            Runs::Unknown => {
                Self::OfGain(projection.variance_beside_even_noise(model).unwrap_or(0.0))
            }
            Runs::Each(each) => {
                let all: Option<Vec<Vec<f64>>> = each.into_iter().map(of_run).collect();
                let mean = all.and_then(|all| SampleMean::of(&all));
                mean.map_or(Self::Unknown, Self::Known)
            }
        }
    }

    /// The ends of the interval of parameter `k` around `x`, with this in them, where `critical` holds at endless degrees of freedom.
    pub(super) fn widened(
        &self,
        k: usize,
        x: f64,
        [lower, upper]: [f64; 2],
        critical: f64,
    ) -> Option<[f64; 2]> {
        let half = match self {
            Self::OfGain(variance) if k == 0 => critical * variance.sqrt(),
            Self::OfGain(_) => 0.0,
            Self::Known(mean) => {
                student_critical(critical, &[mean.degrees()])[0] * mean.covariance(k, k).sqrt()
            }
            Self::Unknown => return None,
        };
        Some([x - (x - lower).hypot(half), x + (upper - x).hypot(half)])
    }

    /// What is added to a covariance.
    pub(super) fn covariance(&self, i: usize, k: usize) -> f64 {
        match self {
            Self::Known(mean) => mean.covariance(i, k),
            Self::OfGain(variance) if (i, k) == (0, 0) => *variance,
            Self::OfGain(_) | Self::Unknown => 0.0,
        }
    }
}
