//! What comes first of a comparison: the servos as machines, or their step responses.

use super::outcome::Comparison;
use super::servo_models::{QuantityDifference, ServoModelComparison};
use super::verdict::Verdict;

impl ServoModelComparison {
    /// Whether they say more than the step responses, `None` where these are not compared. What is sure comes first: how the servos rest, and which has more play, beside responses that are alike, and
    /// what makes them differ where they do. What step responses show comes before machines that are not shown to differ.
    #[must_use]
    pub fn answer_before(&self, step_responses: Option<&Comparison>) -> bool {
        let show = step_responses.is_some_and(Comparison::has_verdict);
        let any_differs = || self.differences().iter().any(QuantityDifference::is_sure);
        let rests_differ = self.rests_apart.differ();
        match step_responses.map(|found| found.verdict) {
            _ if self.more_play().is_some() => true,
            Some(Verdict::Same) => rests_differ,
            Some(Verdict::Different) => any_differs(),
            Some(Verdict::Undecided) | None => {
                rests_differ || any_differs() || self.compares() && !show
            }
        }
    }

    /// Whether they come first, and say how far apart rests are on both sides: then the step responses need not.
    #[must_use]
    pub fn says_rests_before(&self, step_responses: Option<&Comparison>) -> bool {
        self.rests_apart.difference.is_some() && self.answer_before(step_responses)
    }
}
