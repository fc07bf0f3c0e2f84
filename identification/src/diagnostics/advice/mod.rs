//! The sentences of advice: findings, and what to do about each.

mod errors;
mod excitation;
mod record;
mod resolution;
mod response;

use crate::diagnostics::explanation::Explanation;
use crate::options::Options;
use crate::results::advice::{Advice, Check};
use crate::results::model::Model;
use crate::results::validity::Reason;

/// What advice is drawn from.
pub(crate) struct Evidence<'a> {
    /// The model, with the bounds that it has as long as nothing speaks against them.
    pub(crate) model: &'a Model,
    /// Why these bounds do not hold, if they do not.
    pub(crate) withdrawn: Option<Reason>,
    pub(crate) explanation: &'a Explanation,
    pub(crate) options: &'a Options,
    /// Samples of the record, missing ones included.
    pub(crate) samples: usize,
}

/// All findings on a model.
pub(crate) fn gather(evidence: &Evidence<'_>) -> Vec<Advice> {
    [
        errors::model_error(evidence),
        errors::not_linear(evidence),
        excitation::excitation(evidence),
        excitation::smooth(evidence),
        errors::metrics(evidence),
        excitation::metrics(evidence),
        response::settled(evidence),
        response::repeats(evidence),
        response::hidden_tail(evidence),
        response::responds(evidence),
        response::truncated(evidence),
        resolution::coarse(evidence),
        resolution::rounding(evidence),
        record::parameters(evidence),
        errors::slow_noise(evidence),
        errors::whiteness(evidence),
        errors::independence(evidence),
        record::conditioning(evidence),
        record::converged(evidence),
        record::scatter(evidence),
        record::deviating(evidence),
        record::history(evidence),
        record::at_rest(evidence),
    ]
    .into_iter()
    .flatten()
    .collect()
}
