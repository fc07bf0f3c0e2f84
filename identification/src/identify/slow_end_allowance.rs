//! A slow end beside the lags up to N, where the errors can say something of one.

use super::fitted::Fitted;
use super::task::Task;
use crate::data::Record;
use crate::diagnostics::{PriorOutcome, SlowColumns, end_is_unseen, simulated_whole};

/// The input behind slow lags beside all lags up to N. `None` where its share of the errors says nothing of a slow end.
pub(super) fn slow_columns<'a>(task: &Task<'_>, fitted: &'a Fitted) -> Option<&'a SlowColumns> {
    let record = with_noise_for_errors(task, fitted)?;
    let estimate = &fitted.estimate;
    let (moments, fit) = (&estimate.information.moments, &estimate.fit);
    let found = || {
        let level_error = estimate.level_error(record);
        SlowColumns::new(
            &simulated_whole(record, moments, fit),
            moments,
            fit,
            level_error,
        )
    };
    fitted.slow_columns.get_or_init(found).as_ref()
}

/// The record, where its errors are such that their share behind a slow lag says something of a slow end.
fn with_noise_for_errors<'a>(task: &Task<'a>, fitted: &Fitted) -> Option<&'a Record<'a>> {
    let (record, plan) = (task.record?, &fitted.candidate.plan);
    let within_holds = (plan.choice.as_ref()).is_some_and(|choice| choice.within_holds);
    let noise = !fitted.errors_follow_motion() && fitted.misfit.is_none();
    (noise && !within_holds && plan.basis.is_complete()).then_some(record)
}

/// `fitted` with the covariance that allows for a slow end. The stable prior has one of its own, and who states a settling time states
/// that there is none.
pub(super) fn allowing_for_slow_end(task: &Task<'_>, mut fitted: Fitted) -> Fitted {
    let is_stated = fitted.candidate.plan.choice.is_none() && !task.may_go_on;
    if is_stated || matches!(fitted.prior, Some(PriorOutcome::Used { .. })) {
        return fitted;
    }
    if with_noise_for_errors(task, &fitted).is_none() {
        return fitted;
    }
    let ratio = task.disturbances.outliers.variance_ratio();
    slow_columns(task, &fitted);
    let columns = fitted.slow_columns.get().and_then(Option::as_ref);
    fitted.end_is_unseen = end_is_unseen(columns, fitted.estimate.fit.theta()[0]);
    fitted.allowed_end = columns.map(|columns| columns.allow_in(&mut fitted.estimate.fit, ratio));
    fitted
}
