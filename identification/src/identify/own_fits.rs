//! What the runs of a record show each by itself.
//!
//! Runs whose gains differ bend their common response, and its errors then follow the motion of each. What is found in the common fit
//! alone may be a consequence of that.

use super::fitted::Fitted;
use super::task::Task;
use crate::data::Record;
use crate::numerics::chi_square_upper_tail;

/// The probability `p_of` of all runs, each by a fit of its own, [combined]: -2 Σ ln p is χ² of two degrees of freedom a run.
/// `None` of a single run, and where none of them can say.
pub(super) fn p_of_own_fits(
    task: &Task<'_>,
    fitted: &Fitted,
    p_of: impl Fn(&Task<'_>, &Fitted) -> Option<f64>,
) -> Option<f64> {
    let record = task.record.filter(|record| record.runs().len() > 1)?;
    let of_run = |alone: Record<'_>| p_of_fit_to(&alone, (task, fitted), &p_of);
    let found: Vec<f64> = record.each_run().filter_map(of_run).collect();
    combined(&found)
}

/// The probability of independent probabilities as small as these together (Fisher, 1932); `None` without any.
pub(super) fn combined(found: &[f64]) -> Option<f64> {
    let of_one = |p: &f64| -2.0 * p.max(f64::MIN_POSITIVE).ln();
    let sum = found.iter().map(of_one).sum();
    (!found.is_empty()).then(|| chi_square_upper_tail(sum, 2 * found.len()))
}

/// The probability `p_of` of another `record` by a fit of its own, with the structure of the one that was `fitted`.
pub(super) fn p_of_fit_to(
    record: &Record<'_>,
    (task, fitted): (&Task<'_>, &Fitted),
    p_of: impl Fn(&Task<'_>, &Fitted) -> Option<f64>,
) -> Option<f64> {
    let task = Task {
        record: Some(record),
        ..*task
    };
    let plan = &fitted.candidate.plan;
    let candidate = fitted.candidate.with(&task, plan.basis, plan.order);
    let fitted = Fitted::new(&task, candidate).ok()?;
    p_of(&task, &fitted)
}
