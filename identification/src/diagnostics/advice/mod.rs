//! Findings with their numbers, and what to do about each.

mod errors;
mod excitation;
mod record;
mod resolution;
mod response;

use serde::{Deserialize, Serialize};

use crate::diagnostics::explanation::Explanation;
use crate::options::Options;
use crate::results::model::Model;

pub use errors::{MODEL_ERROR, NOT_LINEAR};
pub use excitation::EXCITATION;
pub use resolution::ROUNDING;

/// The checks that take the level from all bounds, and why, in a few words. Where the input does not tell all of
/// the response, errors do not look like noise either: that comes first.
pub(crate) const WITHDRAWING: [(&str, &str); 3] = [
    (
        EXCITATION,
        "the reference does not tell all of the response",
    ),
    (MODEL_ERROR, "the errors are not noise"),
    (
        ROUNDING,
        "the steps of the sensor are larger than the noise",
    ),
];

/// One finding.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Advice {
    /// Short name of the check, stable between versions, such as `settled`.
    pub check: String,
    /// What was found, as one sentence.
    pub finding: String,
    /// The number that was found.
    pub value: f64,
    /// The number it was held against.
    pub threshold: f64,
    /// What to do, as one sentence.
    #[serde(rename = "do")]
    pub remedy: String,
}

impl Advice {
    /// A finding; numbers beyond the finite ones are brought to the largest finite ones, because
    /// the document that carries them has no infinity.
    #[must_use]
    pub fn new(
        check: &str,
        finding: String,
        value: f64,
        threshold: f64,
        remedy: impl Into<String>,
    ) -> Self {
        let finite = |x: f64| {
            if x.is_nan() {
                0.0
            } else {
                x.clamp(f64::MIN, f64::MAX)
            }
        };
        Self {
            check: check.to_owned(),
            finding,
            value: finite(value),
            threshold: finite(threshold),
            remedy: remedy.into(),
        }
    }
}

/// What advice is drawn from.
pub(crate) struct Evidence<'a> {
    pub(crate) model: &'a Model,
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
        errors::figures(evidence),
        excitation::figures(evidence),
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
