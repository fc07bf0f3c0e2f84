//! Whether the servo is seen to rest before its holds end.
//!
//! No model is asked: one of more lags than a hold describes what a servo that is not linear does in each period of a reference that repeats
//! itself, as a response that goes on for several holds. The output shows whether anything moves then.
//!
//! What moves is looked for in the second half of each hold, as far as the usual hold goes, beside the size of the stroke before. Over all
//! holds together even a creep of a few percent is seen that no single hold shows. The levels themselves do not count: play and friction leave
//! the servo beside its command, and at rest.

use crate::data::{HELD, Hold, Record, Run, holds, mean_output, measured_within};
use crate::numerics::{dot, normal_upper_quantile, student_critical};
use crate::thresholds::{
    AT_REST_SIGNIFICANCE, DETECTION, MOVES_AFTER_HOLD, MOVES_LITTLE, SHORTEST_SETTLING,
    STROKES_FOR_REST,
};

/// Parts of the second half. A servo that rings may come to the same mean in both halves of it.
const PARTS: usize = 8;

/// Whether the output of `record` is at rest in the second half of `hold` samples after nearly each change of the input, as far as noise shows.
///
/// `false` where noise, or holds that are few, could hide motion that matters.
pub(crate) fn rests_within(record: &Record, hold: usize) -> bool {
    let parts = PARTS.min(hold / 4);
    if parts < HELD {
        return false;
    }
    let tolerance = measured_within(record);
    let mut ends = Vec::new();
    for run in record.runs() {
        let held = holds(run, tolerance).into_iter();
        let held = held.filter(|found| found.samples.len() >= hold);
        ends.extend(held.filter_map(|found| HoldEnd::of(run, &found, hold, parts)));
    }
    if ends.len() < STROKES_FOR_REST {
        return false;
    }
    let from_first_half = |end: &HoldEnd| {
        let (first, last) = end.parts.split_at(parts / 2);
        mean(last) - mean(first)
    };
    let between_halves = EndMotion::of(&ends, from_first_half);
    let each =
        (0..parts).map(|part| EndMotion::of(&ends, |end| end.parts[part] - mean(&end.parts)));
    let degrees_of_freedom = (ends.len() - 1) as f64;
    let of_normal = normal_upper_quantile(AT_REST_SIGNIFICANCE / (parts + 1) as f64);
    let chance = student_critical(of_normal, &[degrees_of_freedom])[0];
    let is_chance = |motion: EndMotion| motion.share.abs() <= chance * motion.sd;
    between_halves.share.abs() + chance * between_halves.sd < MOVES_LITTLE
        && is_chance(between_halves)
        && each.into_iter().all(is_chance)
}

/// Samples within which the output of `record` rests after nearly each change of the input: the least of the halves of `longest` of which [`rests_within`] says so. `None` where it says
/// so of none.
pub(crate) fn time_until_rest(record: &Record, longest: usize) -> Option<usize> {
    let halves = std::iter::successors(Some(longest), |samples| Some(samples / 2));
    halves
        .take_while(|samples| *samples >= SHORTEST_SETTLING && rests_within(record, *samples))
        .last()
}

/// Whether a response is elsewhere for a quarter of a hold, at any time after `hold` samples, than in the second half of the hold, by more than
/// a creep would be that [`rests_within`] does not see, and by more than its standard deviations `sd` explain.
pub(crate) fn moves_after(step: &[f64], sd: &[f64], hold: usize) -> bool {
    let quarter = hold / 4;
    if quarter == 0 || step.len() < hold + quarter {
        return false;
    }
    let at_rest = mean(&step[hold / 2..hold]);
    let largest = step.iter().fold(0.0, |most: f64, g| most.max(g.abs()));
    let later = step[hold..].chunks_exact(quarter);
    let mut later = later.zip(sd[hold..].chunks_exact(quarter));
    later.any(|(part, sd)| {
        let by_chance = DETECTION * sd.iter().copied().fold(0.0, f64::max);
        (mean(part) - at_rest).abs() > MOVES_AFTER_HOLD * largest + by_chance
    })
}

/// The end of a hold.
struct HoldEnd {
    /// The change of the input before it, with its sign \[input\].
    stroke: f64,
    /// The mean output of equal parts of its second half.
    parts: Vec<f64>,
}

impl HoldEnd {
    /// `None` where the change, or much of the output, is not in the record.
    fn of(run: &Run, held: &Hold, hold: usize, parts: usize) -> Option<Self> {
        let stroke = held.level - held.before?;
        let length = hold / 2 / parts;
        let start = held.samples.start + hold - parts * length;
        let part = |k: usize| mean_output(run, start + k * length..start + (k + 1) * length);
        let parts = (0..parts).map(part).collect::<Option<_>>()?;
        Some(Self { stroke, parts })
    }
}

/// What moves at the ends of holds, as a share of the stroke, with its standard deviation.
#[derive(Clone, Copy)]
struct EndMotion {
    share: f64,
    sd: f64,
}

impl EndMotion {
    /// Of what `moved` there: regressed on the strokes, whose residuals have the noise, whatever its spectrum.
    fn of(ends: &[HoldEnd], moved: impl Fn(&HoldEnd) -> f64) -> Self {
        let strokes: Vec<f64> = ends.iter().map(|end| end.stroke).collect();
        let moved: Vec<f64> = ends.iter().map(moved).collect();
        let squares = dot(&strokes, &strokes);
        let share = dot(&strokes, &moved) / squares;
        let left = dot(&moved, &moved) - share * share * squares;
        let variance = left.max(0.0) / (ends.len() - 1) as f64;
        Self {
            share,
            sd: (variance / squares).sqrt(),
        }
    }
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};

    const HOLD: usize = 100;

    /// The share of a stroke that is left `seconds` after it: a lag of 30 ms, and a slow one.
    fn left(seconds: f64, (share, slow_s): (f64, f64)) -> f64 {
        (1.0 - share) * (-seconds / 0.03).exp() + share * (-seconds / slow_s).exp()
    }

    /// Stairs of 10 degrees in rows of 5 ms, with noise of 0.05 that remembers the share `memory` of its last value.
    fn stairs(
        strokes: usize,
        answer: impl Fn(f64) -> f64,
        memory: f64,
        seed: u64,
    ) -> Record<'static> {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut normal = || -> f64 { StandardNormal.sample(&mut random) };
        let level = |hold: usize| 10.0 * [0.0, 1.0, 2.0, 1.0][hold % 4];
        let input: Vec<f64> = (0..strokes * HOLD).map(|k| level(k / HOLD)).collect();
        let mut noise = 0.0;
        let output = (0..input.len()).map(|k| {
            noise = memory * noise + 0.05 * (1.0 - memory * memory).sqrt() * normal();
            let since = |stroke: usize| 0.005 * (k - stroke * HOLD) as f64;
            let steps = (1..=k / HOLD)
                .map(|stroke| (level(stroke) - level(stroke - 1)) * (1.0 - answer(since(stroke))));
            steps.sum::<f64>() + noise
        });
        let output: Vec<f64> = output.collect();
        Record::of_run(0.005, input, output).unwrap()
    }

    #[test]
    fn a_servo_at_rest_is_seen_to_rest() {
        for seed in 0..10 {
            let record = stairs(60, |t| left(t, (0.0, 1.0)), 0.0, seed);
            assert!(rests_within(&record, HOLD), "{seed}");
        }
    }

    /// The slow ends of the hard recordings: 3 % and more with 200 and 400 ms.
    #[test]
    fn a_servo_that_creeps_is_not() {
        for (share, slow_s) in [(0.03, 0.2), (0.03, 0.4), (0.1, 0.2), (0.1, 0.4)] {
            for memory in [0.0, 0.9] {
                for seed in 0..5 {
                    let record = stairs(60, |t| left(t, (share, slow_s)), memory, seed);
                    let rests = rests_within(&record, HOLD);
                    assert!(!rests, "{share}, {slow_s}, {memory}, {seed}");
                }
            }
        }
    }

    /// A ring of 8 Hz: a whole period in each quarter of a hold.
    #[test]
    fn neither_is_one_that_rings() {
        let ringing = |t: f64| (-t / 0.2).exp() * (std::f64::consts::TAU * 8.0 * t).cos();
        assert!(!rests_within(&stairs(60, ringing, 0.0, 1), HOLD));
    }

    #[test]
    fn a_response_that_goes_on_contradicts_rest_and_a_creep_of_two_percent_does_not() {
        let step = |share: f64| -> Vec<f64> {
            let at = |k: usize| 1.0 - left(0.005 * k as f64, (share, 1.0));
            (0..6 * HOLD).map(at).collect()
        };
        let moves = |step: &[f64], sd: f64| moves_after(step, &vec![sd; step.len()], HOLD);
        assert!(moves(&step(0.1), 0.0));
        assert!(!moves(&step(0.02), 0.0));
        assert!(!moves(&step(0.1)[..HOLD + 10], 0.0));
        assert!(!moves(&step(0.1), 0.03));
    }

    #[test]
    fn a_few_holds_show_no_rest() {
        let record = stairs(STROKES_FOR_REST, |t| left(t, (0.0, 1.0)), 0.0, 1);
        assert!(!rests_within(&record, HOLD));
    }
}
