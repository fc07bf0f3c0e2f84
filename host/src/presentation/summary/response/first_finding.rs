//! The finding that comes before any sentence about a servo.

use servoid_identification::results::{Advice, Model, Precedence};

/// The finding on a model that leaves nothing to be said before it: times that cannot be, columns that are exchanged, a loop, or no
/// model that predicts the recording.
pub(crate) fn first_finding(model: &Model) -> Option<&Advice> {
    model
        .advice
        .iter()
        .find(|item| item.precedence() == Precedence::InPlaceOfTheAnswer)
}

/// Whether that no bounds can be given is said before the first finding: it is the answer. Columns that are exchanged are the reason
/// of all that follows from them, and come first.
pub(crate) fn answers_first(model: &Model) -> bool {
    let exchanged = first_finding(model).is_some_and(Advice::is_of_exchange);
    model.step.bounds.withdrawn().is_some() && !exchanged
}

/// The first finding that is said before the sentence on a servo, which stands all the same.
pub(crate) fn said_before(model: &Model) -> Option<&Advice> {
    model
        .advice
        .iter()
        .find(|item| item.precedence() == Precedence::BeforeTheAnswer)
}
