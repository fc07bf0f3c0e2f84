//! Gate: does the servo, if it is not linear, respond for no longer than the input is held?
//!
//! Protects: N of a servo that is not linear. Beyond the usual hold the next steps are under way, and how they
//! are answered differently because of this one passes for a late part of its response.
//!
//! If not, N is chosen again among settling times up to the usual hold. Holds that are too short for a choice,
//! or for the response, limit nothing.

use crate::data::usual_hold;
use crate::error::Error;
use crate::identify::candidate::Candidate;
use crate::identify::fitted::Fitted;
use crate::identify::task::Task;
use crate::options::Options;
use crate::selection::odd_at_most;

pub(super) fn pass(task: &Task<'_>, fitted: Fitted) -> Result<Fitted, Error> {
    let nonlinear = fitted.linearity.is_some_and(|found| found.is_rejected());
    let (Some(record), Some(choice), true) =
        (task.record, &fitted.candidate.plan.choice, nonlinear)
    else {
        return Ok(fitted);
    };
    let hold = usual_hold(record);
    if choice.settling <= hold {
        return Ok(fitted);
    }
    let options = Options {
        longest_settling: Some(odd_at_most(hold)),
        ..*task.options
    };
    let Some(shorter) = Candidate::of_record(record, &options)
        .ok()
        .and_then(Candidate::within_holds)
    else {
        return Ok(fitted);
    };
    let shorter = Fitted::new(task, shorter)?;
    Ok(Fitted {
        linearity: shorter.linearity.or(fitted.linearity),
        ..shorter
    })
}
