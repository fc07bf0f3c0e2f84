//! Finding on strokes of a size that few others in the recording have.

use crate::data::{EXACTLY, holds, stroke_sizes};
use crate::diagnostics::advice::evidence::{Evidence, two_digits};
use crate::diagnostics::outlying::taken_out::TakenOut;
use crate::numerics::median;
use crate::results::{Advice, Check};

/// Steps that differ by no more than this share are of one size.
const ALIKE: f64 = 0.1;

pub(super) fn other_strokes(evidence: &Evidence<'_>) -> Option<Advice> {
    let record = evidence.recorded?;
    let taken_out = &evidence.explanation.taken_out;
    let found: Vec<&TakenOut> = taken_out
        .iter()
        .filter(|found| found.other_stroke)
        .collect();
    let first = found.first()?;
    let sizes: Vec<f64> = stroke_sizes(record, EXACTLY).collect();
    let usual = median(sizes.clone())?;
    let run = record.runs().get(first.run - 1)?;
    let mut held = holds(run, EXACTLY).into_iter();
    let hold = held.find(|hold| hold.samples.contains(&first.sample))?;
    let size = (hold.level - hold.before?).abs();
    let samples: usize = found.iter().map(|found| found.samples).sum();
    let alike = sizes
        .iter()
        .filter(|other| (*other - usual).abs() <= ALIKE * usual);
    let usual = evidence.input(two_digits(usual));
    let (others, these) = match 2 * alike.count() > sizes.len() {
        true => (
            format!("the steps of {usual}, which are most of this recording,"),
            format!("steps of {usual}"),
        ),
        false => (
            "most others of this recording,".to_owned(),
            "these".to_owned(),
        ),
    };
    Some(Advice::new(
        Check::Linearity,
        format!(
            "The servo is not linear: a step of {} at {:.3} s is not answered as {others} by more than noise explains. The response, and bounds where \
             there are any, are those of {these}. {samples} samples after steps of other sizes were left out.",
            evidence.input(two_digits(size)),
            hold.samples.start as f64 * evidence.model.sample_period_s
        ),
        size,
        0.0,
        "Record steps of several sizes, such as random levels, and take the servo model: a limit of the speed does this.",
    ))
}
