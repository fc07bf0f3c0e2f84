//! The sentences of advice: findings, and what to do about each.
//!
//! A finding on a model without bounds does not speak of bounds, nor has it a number that is the width of one.

mod errors;
mod evidence;
mod excitation;
mod record;
mod resolution;
mod response;

pub(crate) use evidence::Evidence;

use crate::results::advice::Advice;

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
        resolution::quantised(evidence),
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
