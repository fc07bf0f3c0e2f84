//! What comes first of a comparison: the servos as machines, or their step responses.

use super::outcome::Comparison;
use super::servo_models::{QuantityDifference, ServoModelComparison};
use super::verdict::Verdict;
use super::wear::NAMES_IN_SUMMARY;

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
                rests_differ || any_differs() || self.plays_are_apart() || self.compares() && !show
            }
        }
    }
}

impl Comparison {
    /// The summary beside what is said of the servos as machines: without how far apart both rest, where these come first and say it. `unit` is that of the output.
    #[must_use]
    pub fn summary_beside(&self, machines: Option<&ServoModelComparison>, unit: &str) -> &str {
        let say_rests = machines
            .is_some_and(|found| found.rests_apart.is_known() && found.answer_before(Some(self)));
        let rests = self.rests_in_words(NAMES_IN_SUMMARY, unit);
        let rests = rests.filter(|_| say_rests);
        let shorter = rests.and_then(|rests| self.summary.strip_suffix(&*rests));
        shorter.map_or(&self.summary, str::trim_end)
    }
}
