//! Gate: does the bank hold more than the gain?
//!
//! Protects: users from a "step response" that is one number. A bank that is left with the gain alone, of an
//! input without steps, is none.
//!
//! If not, there is no model, and the error says whether the input or the output is to blame. A bank of one
//! frequency passes where it was asked for, or where it is what predicts best.

use crate::data::Record;
use crate::error::Error;
use crate::estimation::Excitation;
use crate::identify::fitted::Fitted;
use crate::identify::task::Task;
use crate::options::Frequencies;

pub(super) fn pass(task: &Task<'_>, fitted: Fitted) -> Result<Fitted, Error> {
    let asked = matches!(task.options.frequencies, Frequencies::Count(_));
    if fitted.candidate.plan.basis.highest() > 0 || fitted.misfit.is_some() || asked {
        return Ok(fitted);
    }
    let excitation = Excitation::of(&fitted.estimate.information.moments);
    Err(match excitation.is_smooth() {
        _ if task.recorded.is_some_and(Record::steps_before_runs) => Error::StepsBeforeRuns,
        true => Error::NoDetail,
        false => Error::Unanswered,
    })
}
