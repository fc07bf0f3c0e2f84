//! Gate: is the response over after N?
//!
//! Protects: bounds from a slow end that is below the noise in every single lag. A servo that creeps under load has
//! two time scales, and N follows the one that is seen.
//!
//! If not, N is the longest that the record allows. If it is not over then either, bounds lose their level. A servo
//! that is not linear leaves errors that look like slow ends, and so do steps of the sensor and left-out frequencies.

use super::errors_are_noise;
use crate::data::Quantisation;
use crate::diagnostics::{SlowEnd, simulated, slow_end};
use crate::error::Error;
use crate::estimation::FsfBasis;
use crate::identify::assess::figures_of_merit;
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
    if follows_motion
        || fitted.misfit.is_some()
        || choice.within_holds
        || choice.repeats_after.is_some()
        || !candidate.plan.basis.is_complete()
        || is_rounded(task, &fitted)
    {
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
            let linearity = longer.linearity;
            if linearity.is_some_and(|found| found.errors_follow_motion()) {
                let known_to_follow = Fitted {
                    linearity,
                    ..fitted
                };
                return errors_are_noise::pass(task, known_to_follow);
            }
            let longer = errors_are_noise::pass(task, longer)?;
            if longer.misfit.is_none() {
                let slow_end = significant(task, &longer, UNSETTLED_SIGNIFICANCE);
                return Ok(Fitted { slow_end, ..longer });
            }
        }
    }
    Ok(Fitted {
        slow_end: Some(end).filter(|end| end.p < limit),
        ..fitted
    })
}

/// Whether errors are those of the steps of the sensor, which follow the motion too.
fn is_rounded(task: &Task<'_>, fitted: &Fitted) -> bool {
    let rmse = figures_of_merit(fitted, 0).rmse;
    task.record
        .is_some_and(|record| Quantisation::of(record, rmse).is_some())
}

fn significant(task: &Task<'_>, fitted: &Fitted, significance: f64) -> Option<SlowEnd> {
    let moments = &fitted.estimate.information.moments;
    let fit = &fitted.estimate.fit;
    let end = slow_end(&simulated(task.record?, moments, fit), moments, fit)?;
    (end.p < significance).then_some(end)
}
