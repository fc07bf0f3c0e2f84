//! The gates that a fitted candidate passes, in their order.
//!
//! A gate keeps the candidate, puts another one in its place, or refuses: one question, one reason, one file.

mod errors_are_noise;
pub(super) mod input_is_free;
mod more_than_a_gain;
mod response_is_over;
mod within_holds;

use super::fitted::Fitted;
use super::task::Task;
use crate::error::Error;

type Gate = fn(&Task<'_>, Fitted) -> Result<Fitted, Error>;

const GATES: [Gate; 5] = [
    // A servo that is not linear responds for no longer than the input is held, or N is shortened.
    within_holds::pass,
    // The errors are noise, or structure and estimator are chosen by prediction and bounds lose their level.
    errors_are_noise::pass,
    // The response is over after N, or N is the longest, or bounds lose their level.
    response_is_over::pass,
    // The input is not computed from the output, or bounds lose their level.
    input_is_free::pass,
    // More than a gain is determined, or there is no model.
    more_than_a_gain::pass,
];

/// The candidate that is left after all gates.
///
/// # Errors
/// No candidate can be fitted, or a gate refuses.
pub(super) fn pass(task: &Task<'_>, fitted: Fitted) -> Result<Fitted, Error> {
    GATES
        .iter()
        .try_fold(fitted, |fitted, gate| gate(task, fitted))
}
