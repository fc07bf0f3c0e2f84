//! Questions beside the linear response, and whether a reference answers them.
//!
//! The detectors of identification decide, on simulated runs of the reference.

use serde::Serialize;
use servoid_identification::nonlinear::{Limits, RateVerdict, split_by_direction};
use servoid_identification::results::Model;
use servoid_identification::{Options, Record};

/// A question, and whether the reference answers it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Answer {
    /// The question.
    pub question: &'static str,
    /// Whether a recording of this reference answers it.
    pub answered: bool,
    /// Where it does not: the reason, and what to record instead.
    pub why: Option<String>,
}

impl Answer {
    fn new(question: &'static str, answered: bool, why: impl Into<String>) -> Self {
        Self {
            question,
            answered,
            why: (!answered).then(|| why.into()),
        }
    }
}

/// The smallest number of levels that distinguishes a curve from a straight line.
const LEVELS: usize = 3;

/// All questions. Of a detector's finding only the remedy is taken: the finding is about a recording, and here there is
/// none. `example` is identified from `record`.
pub(super) fn of(example: &Model, record: &Record) -> Vec<Answer> {
    // Verdicts alone are read, which have thresholds of their own.
    let limits = Limits::of(record, example, Options::default().level);
    let split = split_by_direction(record, example);
    let no_split = split
        .as_ref()
        .err()
        .map(ToString::to_string)
        .unwrap_or_default();
    let rates = [&limits.rate_up, &limits.rate_down];
    let mut rates = rates.into_iter();
    let silent = rates.find(|rate| rate.verdict == RateVerdict::CannotTell);
    let ends = limits.ends.as_ref();
    let silent_end = ends.and_then(|ends| ends.iter().find(|end| end.softens.is_none()));
    let mut levels: Vec<f64> = limits.levels.iter().map(|cell| cell.command).collect();
    levels.dedup();
    let remedy = |remedy: Option<&String>| remedy.cloned().unwrap_or_default();
    vec![
        Answer::new("do strokes up and down differ", split.is_ok(), no_split),
        Answer::new(
            "is the speed limited",
            silent.is_none(),
            remedy(silent.and_then(|rate| rate.remedy.as_ref())),
        ),
        Answer::new(
            "does the rest position depend on the direction of approach (hysteresis)",
            limits.hysteresis.found.is_some(),
            remedy(limits.hysteresis.remedy.as_ref()),
        ),
        Answer::new(
            "does the travel end within the range",
            ends.is_some() && silent_end.is_none(),
            silent_end.map_or_else(
                || "No level is held long enough to see where the servo rests.".to_owned(),
                |end| remedy(end.remedy.as_ref()),
            ),
        ),
        Answer::new(
            "which level is reached at which command",
            levels.len() >= LEVELS,
            format!(
                "The servo comes to rest at {} levels only; a bend shows from {LEVELS} levels on.",
                levels.len()
            ),
        ),
    ]
}
