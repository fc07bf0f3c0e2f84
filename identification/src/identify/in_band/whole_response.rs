//! All lags of a response and the ends that follow them, as one response.

use faer::Mat;

use crate::data::Record;
use crate::diagnostics::{Tails, simulated_whole};
use crate::estimation::GlsFit;
use crate::identify::estimate::Estimate;
use crate::numerics::times;
use crate::results::frequency_map;

/// An estimate of all lags, and of what follows them.
pub(super) struct WholeResponse {
    pub(super) estimate: Estimate,
    pub(super) tails: Tails,
}

impl WholeResponse {
    /// `None` where moments are not accurate enough for the ends.
    pub(super) fn new(record: &Record<'_>, estimate: Estimate) -> Option<Self> {
        let Estimate {
            information, fit, ..
        } = &estimate;
        let runs = simulated_whole(record, &information.moments, fit);
        let tails = Tails::beside(&runs, &information.moments, fit, prior_sd(fit))?;
        Some(Self { estimate, tails })
    }

    /// Of Re G and Im G in turn at `omegas` \[rad/sample\].
    pub(super) fn functions(&self, omegas: &[f64]) -> Functions {
        let lags = frequency_map(&self.estimate.coordinates, omegas);
        let ends = self.tails.functions(&lags, omegas);
        Functions { lags, ends }
    }

    /// What these make of the estimate.
    pub(super) fn values(&self, Functions { lags, ends }: &Functions) -> Vec<f64> {
        let by_lags = times(lags, self.estimate.fit.solution.response());
        let by_ends = times(ends, self.tails.gains());
        (by_lags.iter().zip(by_ends))
            .map(|(lags, ends)| lags + ends)
            .collect()
    }
}

/// Functions of a response, in rows.
pub(super) struct Functions {
    pub(super) lags: Mat<f64>,
    pub(super) ends: Mat<f64>,
}

/// The standard deviation of the prior of each lag.
fn prior_sd(fit: &GlsFit) -> f64 {
    (fit.variance / fit.precision).sqrt()
}
