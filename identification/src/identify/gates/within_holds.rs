//! Gate: does the servo, if it is not linear, respond for no longer than the input is held?
//!
//! It is not linear where its errors show that, or where its response comes to rest and moves again a hold later.
//!
//! Protects: N of a servo that is not linear. Beyond the usual hold the next steps are under way, and how they
//! are answered differently because of this one passes for a late part of its response.
//!
//! If not, N is chosen again among settling times up to the usual hold. Holds that are too short for a choice,
//! or for the response, limit nothing.

use crate::data::usual_hold;
use crate::diagnostics::moves_again;
use crate::error::Error;
use crate::identify::candidate::Candidate;
use crate::identify::fitted::Fitted;
use crate::identify::task::Task;
use crate::options::Options;
use crate::selection::odd_at_most;

pub(super) fn pass(task: &Task<'_>, fitted: Fitted) -> Result<Fitted, Error> {
    let (Some(record), Some(choice)) = (task.record, &fitted.candidate.plan.choice) else {
        return Ok(fitted);
    };
    let hold = usual_hold(record);
    if choice.settling <= hold {
        return Ok(fitted);
    }
    let estimate = &fitted.estimate;
    let rounding = (estimate.steps_of_sensor(record)).map_or(0.0, |found| found.allowance);
    let moves_again = moves_again(&estimate.information, &estimate.fit, hold, rounding);
    if moves_again.is_none() && !fitted.linearity.is_some_and(|found| found.is_rejected()) {
        return Ok(fitted);
    }
    let options = Options {
        longest_settling: Some(odd_at_most(hold)),
        ..*task.options
    };
    let shorter = Candidate::of_record(record, &options).ok();
    let Some(shorter) = shorter.and_then(|found| found.within_holds(moves_again.is_some())) else {
        return Ok(fitted);
    };
    let shorter = Fitted::new(task, shorter)?;
    Ok(Fitted {
        linearity: shorter.linearity.or(fitted.linearity),
        moves_again,
        ..shorter
    })
}
