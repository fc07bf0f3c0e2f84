//! Gate: is the response over after N?
//!
//! Protects: a step response that ends too soon. A servo that creeps under load has two time scales, and N follows the one that is
//! seen. Bounds allow for a slow end in any case; where it is evident, it is shown.
//!
//! If not, N is the longest that the record allows. If it is not over then either, bounds lose their level, and so they do where N was
//! given. A servo that is not linear leaves errors that look like slow ends, and so do steps of the sensor and left-out frequencies.

use super::errors_are_noise;
use crate::diagnostics::SlowEnd;
use crate::error::Error;
use crate::estimation::FsfBasis;
use crate::identify::fitted::Fitted;
use crate::identify::own_fits::p_of_own_fits;
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

/// The end that is significant in the record and, of several runs, in their own fits: runs whose gains differ bend the common response,
/// and what is bent looks like a slow end.
fn significant(task: &Task<'_>, fitted: &Fitted, significance: f64) -> Option<SlowEnd> {
    let end = slow_columns(task, fitted)?.test();
    let p_of = |task: &Task<'_>, fitted: &Fitted| Some(slow_columns(task, fitted)?.test().p);
    let p_of_runs = || p_of_own_fits(task, fitted, p_of);
    let is_seen = end.p < significance && p_of_runs().is_none_or(|p| p < significance);
    is_seen.then_some(end)
}
