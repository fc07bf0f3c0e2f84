//! Gate: is the response over after N?
//!
//! Protects: bounds from a slow end that is below the noise in every single lag. A servo that creeps under load has
//! two time scales, and N follows the one that is seen.
//!
//! If not, N is the longest that the record allows. If it is not over then either, bounds lose their level. A servo
//! that is not linear leaves errors that look like slow ends, and a bank that leaves frequencies out leaves others.

use crate::diagnostics::{SlowEnd, simulated, slow_end};
use crate::error::Error;
use crate::estimation::FsfBasis;
use crate::identify::fitted::Fitted;
use crate::identify::task::Task;
use crate::selection::Choice;
use crate::thresholds::{SLOW_END_SIGNIFICANCE, UNSETTLED_SIGNIFICANCE};

pub(super) fn pass(task: &Task<'_>, fitted: Fitted) -> Result<Fitted, Error> {
    let candidate = &fitted.candidate;
    let follows_motion = fitted
        .linearity
        .is_some_and(|found| found.errors_follow_motion());
    let Some(choice) = &candidate.plan.choice else {
        return Ok(fitted);
    };
    if follows_motion || choice.repeats_after.is_some() || !candidate.plan.basis.is_complete() {
        return Ok(fitted);
    }
    let Some(end) = significant(task, &fitted, SLOW_END_SIGNIFICANCE) else {
        return Ok(fitted);
    };
    // Where no N was found in the record, mild evidence is enough.
    let limit = match choice.settled {
        true => UNSETTLED_SIGNIFICANCE,
        false => SLOW_END_SIGNIFICANCE,
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
            let slow_end = significant(task, &longer, UNSETTLED_SIGNIFICANCE);
            return Ok(Fitted { slow_end, ..longer });
        }
    }
    Ok(Fitted {
        slow_end: Some(end).filter(|end| end.p < limit),
        ..fitted
    })
}

fn significant(task: &Task<'_>, fitted: &Fitted, significance: f64) -> Option<SlowEnd> {
    let moments = &fitted.estimate.information.moments;
    let fit = &fitted.estimate.fit;
    let end = slow_end(&simulated(task.record?, moments, fit), moments, fit)?;
    (end.p < significance).then_some(end)
}
