//! Gate: does the servo, if it is not linear, respond for no longer than the input is held?
//!
//! It is not linear where its errors show that, where its response comes to rest and moves again a hold later, or where it goes on for several holds
//! although the output is seen to rest in each of them: a reference that repeats itself lets a response as long as its period describe anything that
//! does so, too.
//!
//! Protects: N of a servo that is not linear. Beyond the usual hold the next steps are under way, and how they
//! are answered differently because of this one passes for a late part of its response. The same differences come in each run of one reference,
//! so that several runs are no more evidence of a longer response than one.
//!
//! If not, N is chosen again among settling times up to the usual hold. Holds that are too short for a choice,
//! or for the response, limit nothing. An N that was stated stays, and bounds lose their level.

use crate::data::{Record, usual_hold};
use crate::diagnostics::{moves_after, moves_again, rests_within};
use crate::error::Error;
use crate::estimation::CurveVariance;
use crate::identify::candidate::Candidate;
use crate::identify::estimate::Estimate;
use crate::identify::fitted::Fitted;
use crate::identify::task::Task;
use crate::thresholds::MARGIN;

pub(super) fn pass(task: &Task<'_>, fitted: Fitted) -> Result<Fitted, Error> {
    let plan = &fitted.candidate.plan;
    // A comparison gives N of another choice, which has been here.
    let is_stated = plan.choice.is_none() && !task.may_go_on;
    let (Some(record), true) = (task.record, is_stated || plan.choice.is_some()) else {
        return Ok(fitted);
    };
    let hold = usual_hold(record);
    let settling = plan.basis.settling();
    if settling <= hold {
        return Ok(fitted);
    }
    let estimate = &fitted.estimate;
    let rounding = (estimate.steps_of_sensor(record)).map_or(0.0, |found| found.allowance);
    let moves_again = moves_again(&estimate.information, &estimate.fit, hold, rounding);
    let is_rejected = fitted.linearity.is_some_and(|found| found.is_rejected());
    let outlasts_holds = outlasts_holds(record, settling, hold, estimate);
    let rests = moves_again.is_some() || outlasts_holds.is_some();
    if !rests && !is_rejected {
        return Ok(fitted);
    }
    let shorter = Candidate::of_repeated_errors(record, hold, task.options).ok();
    let Some(shorter) = shorter.and_then(|found| found.within_holds(rests)) else {
        return Ok(fitted);
    };
    if is_stated {
        let stated_beyond_hold = Some(hold);
        return Ok(Fitted {
            stated_beyond_hold,
            ..fitted
        });
    }
    let shorter = Fitted::new(task, shorter)?;
    Ok(Fitted {
        linearity: shorter.linearity.or(fitted.linearity),
        moves_again,
        outlasts_holds,
        ..shorter
    })
}

/// For how many holds the response goes on, where the output is seen to rest within each of them.
fn outlasts_holds(
    record: &Record,
    settling: usize,
    hold: usize,
    estimate: &Estimate,
) -> Option<f64> {
    let Estimate {
        coordinates,
        information,
        fit,
    } = estimate;
    let step = coordinates.basis.step_response(&fit.theta());
    let spread = || CurveVariance::of_fit(information, fit, &coordinates.step_map());
    // A response that is over in the first half of a hold has an acceptable N that is no longer than the hold.
    let holds = settling as f64 / hold as f64;
    let outlasts =
        holds > MARGIN && rests_within(record, hold) && moves_after(&step, &spread().sd, hold);
    outlasts.then_some(holds)
}
