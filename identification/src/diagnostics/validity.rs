//! Whether the bounds of an identification hold, and which of its metrics it supports.
//!
//! This is the one place where that is decided, from the evidence alone.

use crate::diagnostics::explanation::Explanation;
use crate::results::{Interval, Metrics, Model, Reason, Withheld};
use crate::thresholds::DISAGREEMENT;

/// Why the bounds of `model` do not hold, if they do not. An input that excites only part of the response
/// leaves errors that do not look like noise either, so it comes first.
pub(crate) fn reason_against_bounds(explanation: &Explanation, model: &Model) -> Option<Reason> {
    // Under a smooth input the effect of rounding grows with everything else, and nothing bounds it.
    let smooth = || {
        explanation
            .excitation
            .is_some_and(|found| found.is_smooth())
    };
    if explanation.unexcited_above_hz(model).is_some() {
        Some(Reason::InputUnexcited)
    } else if explanation.model_errors.is_some() {
        Some(Reason::ErrorsNotNoise)
    } else if explanation.resolution.is_some() && smooth() {
        Some(Reason::QuantisationAboveNoise)
    } else {
        None
    }
}

/// The metrics of `model` without those that the evidence does not support.
pub(crate) fn supported_metrics(explanation: &Explanation, model: &Model) -> Metrics {
    let metrics = model.metrics;
    if unexcited_share(explanation, model).is_some_and(|share| share > DISAGREEMENT) {
        // The final value is no exception: a bank that is short of frequencies takes others for it.
        return Metrics::withheld(
            Interval::default(),
            Withheld::InputUnexcited,
            metrics.bounds,
        );
    }
    let taken = &model.step.value;
    let Some(errors) = explanation
        .model_errors
        .as_ref()
        .filter(|errors| errors.disagreement(taken) > DISAGREEMENT)
    else {
        return metrics;
    };
    // Where estimators disagree, neither's times are findings. The final value may be one all the same.
    let gain = match (taken.last(), errors.other_step.last()) {
        (Some(a), Some(b)) if (a - b).abs() <= DISAGREEMENT * a.abs() => metrics.dc_gain,
        _ => Interval::default(),
    };
    Metrics::withheld(gain, Withheld::EstimatorsDisagree, metrics.bounds)
}

/// By how much of its final value the step response may be changed by frequencies that the input does not
/// excite; `None` where it excites all.
pub(crate) fn unexcited_share(explanation: &Explanation, model: &Model) -> Option<f64> {
    explanation.unexcited_above_hz(model)?;
    let bounds = model.step.bounds.valid()?;
    Some(bounds.truncation_bias / model.theta[0].abs())
}
