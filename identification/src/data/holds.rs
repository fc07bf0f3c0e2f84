//! The input as holds and strokes.
//!
//! A hold is a stretch of samples over which the input stays within a tolerance of the first of them. For how
//! long an input is held has the tolerance [`HELD_WITHIN`], because an input that was measured has noise. Rests and
//! strokes are read from inputs that are held exactly: at the peaks of a sweep the input hardly moves either, but
//! the servo does.

use std::ops::Range;

use crate::data::column::extent;
use crate::data::record::{Record, Run};
use crate::thresholds::{EQUALLY_LARGE, HELD_WITHIN};

/// A stretch of samples over which the input is held.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Hold {
    pub(crate) samples: Range<usize>,
    pub(crate) level: f64,
    /// The level before, if the change to this one is in the record.
    pub(crate) before: Option<f64>,
}

/// The tolerance of an input that is held exactly.
pub(crate) const EXACTLY: f64 = 0.0;

/// An input that is held has at least so many equal samples.
pub(crate) const HELD: usize = 4;

/// The holds of one run, in order. A missing input ends a hold, and the next has no level before.
pub(crate) fn holds(run: &Run, tolerance: f64) -> Vec<Hold> {
    let mut holds: Vec<Hold> = Vec::new();
    for (k, &level) in run.input().iter().enumerate().filter(|(_, u)| !u.is_nan()) {
        match holds.last_mut() {
            Some(hold) if hold.samples.end == k && (level - hold.level).abs() <= tolerance => {
                hold.samples.end = k + 1;
            }
            previous => {
                let before = match previous {
                    Some(hold) if hold.samples.end == k => Some(hold.level),
                    None if k == 0 => run.input_at_rest(),
                    _ => None,
                };
                holds.push(Hold {
                    samples: k..k + 1,
                    level,
                    before: before.filter(|before| *before != level),
                });
            }
        }
    }
    holds
}

/// The tolerance of an input that was measured, and may have noise \[input\].
pub(crate) fn measured_within(record: &Record) -> f64 {
    let low = record.inputs().fold(f64::INFINITY, f64::min);
    let high = record.inputs().fold(f64::NEG_INFINITY, f64::max);
    HELD_WITHIN * (high - low)
}

/// For how long the input is held after each of its changes, and at the beginning of each run \[samples\]; an
/// input that was measured may have noise.
pub(crate) fn hold_lengths(record: &Record) -> Vec<usize> {
    let tolerance = measured_within(record);
    let holds = record.runs().iter().flat_map(|run| holds(run, tolerance));
    holds.map(|hold| hold.samples.len()).collect()
}

/// The time for which the input is usually held between changes: the median \[samples\].
pub(crate) fn usual_hold(record: &Record) -> usize {
    middle(hold_lengths(record))
}

/// The same of an input that is exactly what it was: one that moves a little with each sample is held for one.
pub(crate) fn usual_exact_hold(record: &Record) -> usize {
    middle(exact_hold_lengths(record))
}

/// The time for which nine of ten holds of such an input last at the least \[samples\].
pub(crate) fn shorter_exact_hold(record: &Record) -> usize {
    let mut lengths = exact_hold_lengths(record);
    lengths.sort_unstable();
    lengths.get(lengths.len() / 10).copied().unwrap_or(0)
}

fn exact_hold_lengths(record: &Record) -> Vec<usize> {
    let holds = record.runs().iter().flat_map(|run| holds(run, EXACTLY));
    holds.map(|hold| hold.samples.len()).collect()
}

fn middle(mut lengths: Vec<usize>) -> usize {
    lengths.sort_unstable();
    lengths.get(lengths.len() / 2).copied().unwrap_or(0)
}

/// Share of the changes of the input after which it is held for at least `samples`.
pub(crate) fn share_held(record: &Record, samples: usize) -> f64 {
    let lengths = hold_lengths(record);
    let held = lengths.iter().filter(|length| **length >= samples).count();
    held as f64 / lengths.len().max(1) as f64
}

/// The sizes of the changes from hold to hold \[input\].
pub(crate) fn stroke_sizes(record: &Record, tolerance: f64) -> impl Iterator<Item = f64> {
    let runs = record.runs().iter();
    runs.flat_map(move |run| sizes_of(&holds(run, tolerance)).collect::<Vec<_>>())
}

fn sizes_of(holds: &[Hold]) -> impl Iterator<Item = f64> {
    (holds.iter()).filter_map(|hold| Some((hold.level - hold.before?).abs()))
}

/// Strokes of a run from which on the first and the last may be smaller than the others.
const WITH_REST: usize = 4;

/// The size of all strokes of the command, where they have one \[input\]; `None` where sizes differ, or the input is not held. The first and the last stroke of
/// a run of four or more may be smaller: from a rest between the levels, and back to it.
///
/// A recording with strokes of one size does not show how a servo answers others.
///
/// ```
/// use servoid_identification::{Record, only_stroke};
/// let stroke = |size: f64| -> Vec<f64> { (0..60).map(|k| size * f64::from(k / 20 % 2)).collect() };
/// let of = |input: Vec<f64>| only_stroke(&Record::of_run(0.01, &input, &input).unwrap());
/// assert_eq!(of(stroke(4.0)), Some(4.0));
/// assert_eq!(of([stroke(4.0), stroke(2.0)].concat()), None);
/// // From a rest in the middle, and back to it.
/// assert_eq!(of([vec![2.0; 20], stroke(4.0), stroke(4.0), vec![2.0; 20]].concat()), Some(4.0));
/// // A large one at the end is another size.
/// assert_eq!(of([stroke(4.0), stroke(4.0), vec![9.0; 20]].concat()), None);
/// ```
#[must_use]
pub fn only_stroke(record: &Record) -> Option<f64> {
    let inner_of_run = |run: &Run| {
        let sizes: Vec<f64> = sizes_of(&holds(run, EXACTLY)).collect();
        match &sizes[..] {
            [_, inner @ .., _] if sizes.len() >= WITH_REST => inner.to_vec(),
            _ => sizes,
        }
    };
    let inner = record.runs().iter().flat_map(inner_of_run);
    let (least, _) = extent(inner).filter(|_| usual_hold(record) >= HELD)?;
    let (_, most) = extent(stroke_sizes(record, EXACTLY))?;
    (most - least <= EQUALLY_LARGE * most).then_some(most)
}

/// Whether the command begins at a level that it leaves for ever, and goes to and fro between others.
pub(crate) fn leaves_neutral(input: &[f64]) -> bool {
    let Some(neutral) = input.first() else {
        return false;
    };
    let holds = input[between_ends(input)].chunk_by(|a, b| a == b);
    let mut levels: Vec<f64> = holds.map(|hold| hold[0]).collect();
    let holds = levels.len();
    levels.sort_by(f64::total_cmp);
    levels.dedup();
    2 * levels.len() <= holds && !levels.contains(neutral)
}

/// From the third change of the command to the last one \[samples\]. The first and the last stroke begin or end at some neutral position as no other does, after which a servo
/// with a dead band rests elsewhere; the second begins there.
pub(crate) fn between_ends(input: &[f64]) -> Range<usize> {
    let pairs = input.windows(2).enumerate();
    let mut changes = pairs
        .filter(|(_, pair)| pair[0] != pair[1])
        .map(|(k, _)| k + 1);
    let third = changes.nth(2).unwrap_or(input.len());
    third..changes.next_back().unwrap_or(third)
}

/// Mean output over `samples`, without those missing; `None` when half of them are.
pub(crate) fn mean_output(run: &Run, samples: Range<usize>) -> Option<f64> {
    let wanted = samples.len();
    let present = run.output()[samples].iter().filter(|y| !y.is_nan());
    let (count, sum) = present.fold((0usize, 0.0), |(n, sum), y| (n + 1, sum + y));
    (count > 0 && 2 * count >= wanted).then(|| sum / count as f64)
}

/// The last quarter of a hold.
pub(crate) fn last_quarter(samples: &Range<usize>) -> Range<usize> {
    samples.end - (samples.len() / 4).max(1)..samples.end
}

/// A change of the input with standstill before and after.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Stroke {
    /// The sample of the change, counted over all runs.
    pub(crate) at: usize,
    /// Change of the input, with its sign.
    pub(crate) size: f64,
    /// What was travelled, positive in the direction commanded \[output\].
    pub(crate) travel: f64,
    /// Mean speeds over the middle of the travel, 20 to 80 % and 35 to 65 % of it
    /// \[output per second\].
    pub(crate) speed: f64,
    pub(crate) mid_speed: f64,
    /// Mean speeds over [`PARTS_OF_TRAVEL`] \[output per second\].
    pub(crate) speeds: [f64; 3],
}

/// Parts of the travel as long as its middle: a servo that gets to its top speed late, or begins to brake early, has it in the first or the last of them.
const PARTS_OF_TRAVEL: [(f64, f64); 3] = [(0.2, 0.5), (0.35, 0.65), (0.5, 0.8)];

/// The isolated strokes of a record: at least half of `settling` samples of hold before and all
/// of it after.
pub(crate) fn strokes(record: &Record, settling: usize) -> Vec<Stroke> {
    let period = record.sample_period_s();
    let mut strokes = Vec::new();
    let mut before_run = 0;
    for run in record.runs() {
        let holds = holds(run, EXACTLY);
        let found_before = strokes.len();
        strokes.extend(from_stated_rest(run, holds.first(), settling, period));
        for pair in holds.windows(2) {
            let (before, after) = (&pair[0], &pair[1]);
            let isolated = after.before.is_some()
                && 2 * before.samples.len() >= settling
                && after.samples.len() >= settling;
            if isolated && let Some(start) = mean_output(run, last_quarter(&before.samples)) {
                // From standstill: a fast servo has left it by the first sample after the edge.
                let first = after.samples.start - before.samples.len().min(3);
                strokes.extend(measure(run, (first, start), after, period));
            }
        }
        let of_run = &mut strokes[found_before..];
        of_run.iter_mut().for_each(|stroke| stroke.at += before_run);
        before_run += run.len();
    }
    strokes
}

/// The stroke with which a run begins, where the input before it is stated: its servo is at rest in the first sample, which no
/// answer has reached yet.
fn from_stated_rest(
    run: &Run,
    hold: Option<&Hold>,
    settling: usize,
    period: f64,
) -> Option<Stroke> {
    let isolated = |hold: &&Hold| {
        hold.samples.start == 0 && hold.before.is_some() && hold.samples.len() >= settling
    };
    let start = run.output().first().copied().filter(|y| y.is_finite())?;
    measure(run, (0, start), hold.filter(isolated)?, period)
}

/// The stroke to the hold `after`, from the output `start` at rest; its motion is read from the sample `first` on.
fn measure(run: &Run, (first, start): (usize, f64), after: &Hold, period: f64) -> Option<Stroke> {
    let travel = mean_output(run, last_quarter(&after.samples))? - start;
    let relative: Vec<f64> = run.output()[first..after.samples.end]
        .windows(3)
        .map(|w| (w.iter().sum::<f64>() / 3.0 - start) / travel)
        .collect();
    let crossing = |level: f64| {
        let k = relative.iter().position(|z| *z >= level)?;
        let (low, high) = (*relative.get(k.checked_sub(1)?)?, relative[k]);
        let between = (level - low) / (high - low);
        // A missing sample on the way makes this NaN.
        between.is_finite().then_some((k - 1) as f64 + between)
    };
    let speed = |from: f64, to: f64| {
        let duration = (crossing(to)? - crossing(from)?) * period;
        (duration > 0.0).then(|| (to - from) * travel.abs() / duration)
    };
    let size = after.level - after.before?;
    let [first_half, middle, last_half] = PARTS_OF_TRAVEL.map(|(from, to)| speed(from, to));
    let mid_speed = middle?;
    Some(Stroke {
        at: after.samples.start,
        size,
        travel: travel * size.signum(),
        speed: speed(0.2, 0.8)?,
        mid_speed,
        speeds: [first_half?, mid_speed, last_half?],
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_abs_diff_eq;

    #[test]
    fn holds_end_where_the_input_moves_or_is_missing() {
        let input = vec![1.0, 1.0, 2.0, 2.0, f64::NAN, 2.0, 3.0];
        let run = Run::new(input, vec![0.0; 7])
            .unwrap()
            .with_input_at_rest(0.0);
        let found: Vec<(Range<usize>, Option<f64>)> = holds(&run, EXACTLY)
            .into_iter()
            .map(|hold| (hold.samples, hold.before))
            .collect();
        let expected = [
            (0..2, Some(0.0)),
            (2..4, Some(1.0)),
            (5..6, None),
            (6..7, Some(2.0)),
        ];
        assert_eq!(found, expected);
    }

    #[test]
    fn the_usual_hold_allows_for_the_noise_of_a_measured_input() {
        let noise = |k: usize| 0.01 * (k * 7919 % 101) as f64 / 101.0;
        let input: Vec<f64> = (0..100).map(|k| (k / 20 % 2) as f64 + noise(k)).collect();
        let run = Run::new(input.clone(), input).unwrap();
        assert!(holds(&run, EXACTLY).len() > 90);
        let record = Record::new(0.01, vec![run]).unwrap();
        assert_eq!(usual_hold(&record), 20);
        assert_eq!(
            [20, 21].map(|samples| share_held(&record, samples)),
            [1.0, 0.0]
        );
    }

    #[test]
    fn a_straight_stroke_has_its_own_speed_whichever_part_is_timed() {
        let input: Vec<f64> = (0..80).map(|k| if k < 30 { 0.0 } else { 4.0 }).collect();
        let output: Vec<f64> = (0..80)
            .map(|k| (f64::from(k - 35) * 0.25).clamp(0.0, 4.0))
            .collect();
        let record = Record::of_run(0.01, &input, &output).unwrap();
        let found = strokes(&record, 40);
        assert_eq!(found.len(), 1);
        assert_abs_diff_eq!(found[0].speed, 25.0, epsilon = 1e-9);
        assert_abs_diff_eq!(found[0].mid_speed, 25.0, epsilon = 1e-9);
        assert!(strokes(&record, 60).is_empty());
    }

    #[test]
    fn a_run_that_begins_with_its_step_has_that_stroke_where_the_input_before_is_stated() {
        let input: Vec<f64> = (0..60).map(|k| if k < 50 { 4.0 } else { 5.0 }).collect();
        let output: Vec<f64> = (0..60)
            .map(|k| (f64::from(k - 5) * 0.25).clamp(0.0, 4.0))
            .collect();
        let found = |run: Run| strokes(&Record::new(0.01, vec![run]).unwrap(), 40);
        let run = Run::new(input, output).unwrap();
        assert!(found(run.clone()).is_empty());
        assert!(found(run.clone().with_input_at_rest(4.0)).is_empty());
        let stroke = found(run.with_input_at_rest(0.0))[0];
        assert_abs_diff_eq!(stroke.size, 4.0, epsilon = 1e-9);
        assert_abs_diff_eq!(stroke.speed, 25.0, epsilon = 1e-9);
    }
}
