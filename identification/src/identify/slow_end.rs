//! A slow end beside the lags up to N, where the errors can say something of one.

use super::assess::figures_of_merit;
use super::fitted::Fitted;
use super::task::Task;
use crate::data::Quantisation;
use crate::diagnostics::{PriorOutcome, SlowColumns, simulated_whole};

/// The input behind slow lags beside all lags up to N. `None` where its share of the errors says nothing of a slow end.
pub(super) fn slow_columns(task: &Task<'_>, fitted: &Fitted) -> Option<SlowColumns> {
    let (record, plan) = (task.record?, &fitted.candidate.plan);
    let chosen_otherwise = (plan.choice.as_ref())
        .is_some_and(|choice| choice.within_holds || choice.repeats_after.is_some());
    let follows_motion = fitted
        .linearity
        .is_some_and(|found| found.errors_follow_motion());
    // Errors of the steps of the sensor follow the motion too.
    let is_rounded = || {
        let rmse = figures_of_merit(fitted, 0).rmse;
        Quantisation::of(record, rmse).is_some()
    };
    if follows_motion
        || chosen_otherwise
        || fitted.misfit.is_some()
        || !plan.basis.is_complete()
        || is_rounded()
    {
        return None;
    }
    let estimate = &fitted.estimate;
    let (moments, fit) = (&estimate.information.moments, &estimate.fit);
    SlowColumns::new(&simulated_whole(record, moments, fit), moments, fit)
}

/// `fitted` with the covariance that allows for a slow end. The stable prior has one of its own, and who states a settling time states
/// that there is none.
pub(super) fn allowing_for_slow_end(task: &Task<'_>, mut fitted: Fitted) -> Fitted {
    let is_stated = fitted.candidate.plan.choice.is_none() && !task.may_go_on;
    if is_stated || matches!(fitted.prior, Some(PriorOutcome::Used { .. })) {
        return fitted;
    }
    let ratio = task.disturbances.outliers.variance_ratio();
    fitted.allowed_end = slow_columns(task, &fitted)
        .map(|columns| columns.allow_in(&mut fitted.estimate.fit, ratio));
    fitted
}
