//! Gate: does the bank hold more than the gain?
//!
//! Protects: users from a "step response" that is one number. A bank that is left with the gain alone, of an
//! input without steps, is none.
//!
//! If not, there is no model, and the error says whether the input or the output is to blame: a step within the history of the first
//! rows that are used is answered before them. A bank of one
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
    let moments = &fitted.estimate.information.moments;
    let rows = moments.input_lags();
    let in_history = |record: &Record| record.steps_within_first(rows);
    Err(match Excitation::of(moments).is_smooth() {
        _ if task.recorded.is_some_and(Record::steps_before_runs) => Error::StepsBeforeRuns,
        _ if task.recorded.is_some_and(in_history) => Error::StepsInHistory { rows },
        true => Error::NoDetail,
        false => Error::Unanswered,
    })
}
