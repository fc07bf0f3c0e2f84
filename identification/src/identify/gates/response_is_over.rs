//! Gate: is the response over after N?
//!
//! Protects: a step response that ends too soon. A servo that creeps under load has two time scales, and N follows the one that is
//! seen. Bounds allow for a slow end in any case; where it is evident, it is shown.
//!
//! If not, N is the longest that the record allows. If it is not over then either, bounds lose their level, and so they do where N was
//! given. A servo that is not linear leaves errors that look like slow ends, and so do steps of the sensor and left-out frequencies. With a dead band a servo rests elsewhere
//! after the first stroke of a run, from neutral, than after all others: an end is seen without the first two and the last one, too.

use super::errors_are_noise;
use crate::data::{Run, between_ends, leaves_neutral};
use crate::diagnostics::SlowEnd;
use crate::error::Error;
use crate::estimation::FsfBasis;
use crate::identify::fitted::Fitted;
use crate::identify::own_fits::{p_of_fit_to, p_of_own_fits};
use crate::identify::slow_end_allowance::slow_columns;
use crate::identify::task::Task;
use crate::selection::Choice;
use crate::thresholds::{SLOW_END_SIGNIFICANCE, UNSETTLED_SIGNIFICANCE};

pub(super) fn pass(task: &Task<'_>, fitted: Fitted) -> Result<Fitted, Error> {
    let candidate = &fitted.candidate;
    let Some(choice) = &candidate.plan.choice else {
        let slow_end = significant(task, &fitted, SLOW_END_SIGNIFICANCE);
        return Ok(Fitted { slow_end, ..fitted });
    };
    // Where no N was found in the record, mild evidence is enough.
    let limit = match choice.settled {
        true => SLOW_END_SIGNIFICANCE,
        false => UNSETTLED_SIGNIFICANCE,
    };
    let Some(end) = significant(task, &fitted, limit) else {
        return Ok(fitted);
    };
    if choice.settling < choice.longest {
        let choice = Choice {
            settling: choice.longest,
            for_slow_end: true,
            ..choice.clone()
        };
        let mut longer =
            candidate.with(task, FsfBasis::full(choice.settling)?, candidate.plan.order);
        longer.plan.choice = Some(choice);
        if let Ok(longer) = Fitted::new(task, longer) {
            if longer.errors_follow_motion() {
                let known_to_follow = Fitted {
                    linearity: longer.linearity,
                    ..fitted
                };
                return errors_are_noise::pass(task, known_to_follow);
            }
            let longer = errors_are_noise::pass(task, longer)?;
            if longer.misfit.is_none() {
                let slow_end = significant(task, &longer, SLOW_END_SIGNIFICANCE);
                return Ok(Fitted { slow_end, ..longer });
            }
        }
    }
    Ok(Fitted {
        slow_end: Some(end),
        ..fitted
    })
}

/// The end that is significant in the record, between the ends of its runs and, of several runs, in their own fits: runs whose gains differ bend the common response,
/// as a first stroke that is not like the others does, and what is bent looks like a slow end.
fn significant(task: &Task<'_>, fitted: &Fitted, significance: f64) -> Option<SlowEnd> {
    let end = slow_columns(task, fitted)?.test();
    let p_of_runs = || p_of_own_fits(task, fitted, p_of_end);
    let is_seen = end.p < significance
        && p_of_runs().is_none_or(|p| p < significance)
        && p_between_ends(task, fitted).is_none_or(|p| p < significance);
    is_seen.then_some(end)
}

/// The probability of the end by a fit [between the ends](between_ends) of each run. `None` where no run leaves a neutral level for ever, and where these
/// ends are most of the record.
fn p_between_ends(task: &Task<'_>, fitted: &Fitted) -> Option<f64> {
    let record = task.record?;
    if !record.runs().iter().any(|run| leaves_neutral(run.input())) {
        return None;
    }
    let inner = record.with_runs(record.runs().iter().map(without_ends).collect());
    let kept = inner.outputs().filter(|y| !y.is_nan()).count();
    if 2 * kept < inner.outputs().count() {
        return None;
    }
    p_of_fit_to(&inner, (task, fitted), p_of_end)
}

fn p_of_end(task: &Task<'_>, fitted: &Fitted) -> Option<f64> {
    Some(slow_columns(task, fitted)?.test().p)
}

/// The run with the outputs alone that are [between its ends](between_ends).
fn without_ends<'r>(run: &Run<'r>) -> Run<'r> {
    let inner = between_ends(run.input());
    let outputs = run.output().iter().enumerate();
    let kept = |(k, y): (usize, &f64)| if inner.contains(&k) { *y } else { f64::NAN };
    run.with_output(outputs.map(kept).collect())
}
