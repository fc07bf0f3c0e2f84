//! All lags of a response and the ends that follow them, as one response.

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

    /// Re G and Im G in turn at `omegas` \[rad/sample\].
    pub(super) fn values(&self, omegas: &[f64]) -> Vec<f64> {
        let map = frequency_map(&self.estimate.coordinates, omegas);
        let by_ends = self.tails.functions(&map, omegas);
        let ends = times(&by_ends, self.tails.gains());
        let lags = times(&map, self.estimate.fit.solution.response());
        lags.iter()
            .zip(&ends)
            .map(|(lags, ends)| lags + ends)
            .collect()
    }
}

/// The standard deviation of the prior of each lag.
fn prior_sd(fit: &GlsFit) -> f64 {
    (fit.variance / fit.precision).sqrt()
}
