//! Metrics that the record does not support are withheld.

use super::explanation::Explanation;
use super::misfit::Misfit;
use crate::results::metrics::{Interval, Metrics};
use crate::results::model::Model;
use crate::results::step_response::StepResponse;
use crate::thresholds::DISAGREEMENT;

/// The metrics of `model` without those that depend on the estimator, or on frequencies that the input lacks.
pub(crate) fn withheld(model: &Model, explanation: &Explanation) -> Metrics {
    let mut metrics = model.metrics;
    if let Some(misfit) = &explanation.model_errors {
        metrics = without_disputed(metrics, misfit, &model.step.value);
    }
    // The final value is no exception: a bank that lacks frequencies takes their contribution for it.
    if explanation.unexcited_above_hz(model).is_some()
        && unexcited_share(&model.step, model.theta[0]) > DISAGREEMENT
    {
        metrics = Metrics::gain_alone(Interval::default());
    }
    metrics
}

/// Where two estimators disagree, the times of neither are findings, and where they disagree about the final
/// value, that is none either.
fn without_disputed(metrics: Metrics, misfit: &Misfit, taken: &[f64]) -> Metrics {
    if misfit.disagreement(taken) <= DISAGREEMENT {
        return metrics;
    }
    let gain = match (taken.last(), misfit.other_step.last()) {
        (Some(a), Some(b)) if (a - b).abs() <= DISAGREEMENT * a.abs() => metrics.dc_gain,
        _ => Interval::default(),
    };
    Metrics::gain_alone(gain)
}

/// By how much of its final value `gain` the step response may be changed by frequencies left out.
pub(crate) fn unexcited_share(step: &StepResponse, gain: f64) -> f64 {
    step.truncation_bias / gain.abs()
}
