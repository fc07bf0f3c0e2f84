//! The references of both sides, and whether they are the same.
//!
//! A linear servo has one response to any motion. Any other has one for each kind and size of motion, so that
//! recordings of one servo under two references differ as those of two servos do.

use serde::{Deserialize, Serialize};

use crate::data::column::extent;
use crate::data::{HELD, Hold, Record, Run, hold_lengths, holds, measured_within, usual_hold};
use crate::numerics::{command_in_words, median, with_unit};
use crate::thresholds::{EQUALLY_LARGE, EQUALLY_LONG, RANDOM_ENDS};

/// More levels than this are many.
const MOST_LEVELS: usize = 16;

/// The reference of one side.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Motion {
    /// Smallest input.
    pub lowest: f64,
    /// Largest input.
    pub highest: f64,
    /// Number of levels of an input of steps; `None` when they are many, or it moves smoothly.
    pub levels: Option<usize>,
    /// For how long a level is usually held \[s\].
    pub hold_s: f64,
    /// For how long a level is held on average \[s\].
    #[serde(default)]
    pub mean_hold_s: f64,
    /// For how long one is held at least \[s\].
    #[serde(default)]
    pub shortest_hold_s: f64,
    /// Whether it is held at all between changes.
    #[serde(default)]
    pub held: bool,
}

impl Motion {
    /// That of a record.
    pub(super) fn of(record: &Record) -> Self {
        // A record has an input that moves.
        let (lowest, highest) = ends(record);
        let held = is_held(record);
        let levels = levels_of(record, held);
        let lengths = hold_lengths(record);
        let mean = lengths.iter().sum::<usize>() as f64 / lengths.len().max(1) as f64;
        let shortest = lengths.iter().min().copied().unwrap_or(0);
        Self {
            lowest,
            highest,
            mean_hold_s: mean * record.sample_period_s(),
            shortest_hold_s: shortest as f64 * record.sample_period_s(),
            levels: (2..=MOST_LEVELS).contains(&levels).then_some(levels),
            hold_s: usual_hold(record) as f64 * record.sample_period_s(),
            held,
        }
    }

    /// Whether both are of one size and kind.
    #[must_use]
    pub fn is_like(&self, other: &Self) -> bool {
        let range = (self.highest - self.lowest).max(other.highest - other.lowest);
        // The ends and holds of random levels are random.
        let (equally_large, equally_long) = match self.has_random_levels() {
            true => (RANDOM_ENDS, EQUALLY_LONG.powi(2)),
            false => (EQUALLY_LARGE, EQUALLY_LONG),
        };
        let near = |a: f64, b: f64| (a - b).abs() <= equally_large * range;
        let as_long = self.is_held_as_long(other, equally_long) || self.has_the_same_chips(other);
        near(self.lowest, other.lowest)
            && near(self.highest, other.highest)
            && self.levels == other.levels
            && self.held == other.held
            && (!self.held || as_long)
    }

    fn is_held_as_long(&self, other: &Self, equally_long: f64) -> bool {
        let longer = self.hold_s.max(other.hold_s);
        longer <= equally_long * self.hold_s.min(other.hold_s)
    }

    /// Whether both are binary sequences of the same chips: half of their holds are one chip long, so that the median of each draw is one chip or
    /// two. The mean is the same for all, but for chance: that of a hundred holds is a tenth off.
    fn has_the_same_chips(&self, other: &Self) -> bool {
        let near = |a: f64, b: f64, times: f64| a.max(b) <= times * a.min(b);
        self.is_between_two_levels()
            && near(self.shortest_hold_s, other.shortest_hold_s, EQUALLY_LONG)
            && near(self.mean_hold_s, other.mean_hold_s, EQUALLY_LONG.powi(2))
    }

    /// Whether all strokes go to and fro between two levels, which determine no servo as a machine.
    #[must_use]
    pub fn is_between_two_levels(&self) -> bool {
        self.levels == Some(2)
    }

    fn has_random_levels(&self) -> bool {
        self.held && self.levels.is_none()
    }

    /// Whether both are random levels, and not the same ones.
    pub(super) fn is_another_draw(&self, other: &Self) -> bool {
        self.has_random_levels() && [self.lowest, self.highest] != [other.lowest, other.highest]
    }

    /// By which fraction the larger of the two ranges exceeds the smaller.
    pub(super) fn larger_by(&self, other: &Self) -> f64 {
        larger_by([self, other].map(|motion| motion.highest - motion.lowest))
    }

    /// "the strokes differ, ±4 against ±5 deg", or in what else the references differ.
    #[must_use]
    pub fn difference_in_words(&self, other: &Self, unit: &str) -> String {
        if self.levels.is_some() && self.levels == other.levels && self.larger_by(other) > 0.0 {
            return strokes_differ([self, other].map(Self::ends_in_words), unit);
        }
        let (a, b) = (self.in_words(unit), other.in_words(unit));
        match a == b {
            true => format!("the references differ in their strokes (both have {a})"),
            false => format!("the references differ (the first has {a}; the second has {b})"),
        }
    }

    /// "±5", or "-3 to +5".
    fn ends_in_words(&self) -> String {
        let [low, high] = [self.lowest, self.highest].map(rounded);
        match low == -high {
            true => format!("±{high}"),
            false => format!("{} to {}", self.command(low), self.command(high)),
        }
    }

    fn command(&self, command: f64) -> String {
        command_in_words(command, self.lowest)
    }

    /// "2 levels from -5 to +5 deg, usually held for 0.3 s"; `unit` is that of the input, empty where it is not
    /// known.
    #[must_use]
    pub fn in_words(&self, unit: &str) -> String {
        let [lowest, highest] = [self.lowest, self.highest].map(|end| self.command(rounded(end)));
        let range = format!("from {lowest} to {}", with_unit(highest, unit));
        match self.levels {
            Some(levels) => format!(
                "{levels} levels {range}, usually held for {} s",
                rounded(self.hold_s)
            ),
            None if self.held => format!(
                "steps between many levels {range}, usually held for {} s",
                rounded(self.hold_s)
            ),
            None => format!("a smooth motion {range}"),
        }
    }
}

/// Whether the input is held between changes. What moves slowly stays within the tolerance of a hold for some samples, too: then it goes on from
/// one hold to the next by a small part of that, and not by a step.
fn is_held(record: &Record) -> bool {
    let tolerance = measured_within(record);
    let step = |run: &Run, pair: &[Hold]| {
        let before = run.input()[pair[0].samples.end - 1];
        (run.input()[pair[1].samples.start] - before).abs()
    };
    let steps = record.runs().iter().flat_map(|run| {
        let holds = holds(run, tolerance);
        let steps: Vec<f64> = holds.windows(2).map(|pair| step(run, pair)).collect();
        steps
    });
    let is_step = median(steps.collect()).is_some_and(|step| step > tolerance / 2.0);
    usual_hold(record) >= HELD && is_step
}

/// The number of levels of the input.
fn levels_of(record: &Record, held: bool) -> usize {
    let mut inputs = inputs_of_motion(record);
    inputs.sort_by(f64::total_cmp);
    let apart = measured_within(record);
    let further = |pair: &&[f64]| pair[1] - pair[0] > apart;
    let lying_apart = 1 + inputs.windows(2).filter(further).count();
    inputs.dedup();
    // Every value is a level, but of an input that was measured, which has several in a hold: of that, values that lie together are one. One that moves smoothly has gaps where
    // it turns, and no levels.
    let holds = hold_lengths(record).len();
    match held && inputs.len() > HELD_AGAIN * holds {
        true => lying_apart,
        false if held => levels_missed(&inputs, holds).unwrap_or(inputs.len()),
        false => inputs.len(),
    }
}

/// The number of levels where a hand or a controller misses each by a little, so that hardly one of the `values`, in order, is held again: in
/// `holds` they lie in groups that are narrow beside what is between them. Random levels lie in none.
fn levels_missed(values: &[f64], holds: usize) -> Option<usize> {
    if holds >= HELD_AGAIN * values.len() {
        return None;
    }
    let largest = (values.windows(2).map(|pair| pair[1] - pair[0])).fold(0.0, f64::max);
    let groups: Vec<&[f64]> = (values.chunk_by(|a, b| b - a < APART * largest)).collect();
    let is_narrow = |group: &&[f64]| group[group.len() - 1] - group[0] < NARROW * largest;
    (holds >= HELD_AGAIN * groups.len() && groups.iter().all(is_narrow)).then_some(groups.len())
}

/// Holds of each level on average from which a reference comes back to its levels.
const HELD_AGAIN: usize = 2;

/// Shares of the largest distance between neighbouring values: two that are so far apart are two levels, and those of one level lie within so much.
const APART: f64 = 0.5;
const NARROW: f64 = 0.25;

/// The inputs without the holds between the ends of the range with which runs begin and end: they wait at neutral, which is no level of the motion.
fn inputs_of_motion(record: &Record) -> Vec<f64> {
    let tolerance = measured_within(record);
    let (lowest, highest) = ends(record);
    let is_inside =
        |hold: &Hold| hold.level > lowest + tolerance && hold.level < highest - tolerance;
    let of_run = |run: &Run| {
        let holds = holds(run, tolerance);
        let last = holds.len().saturating_sub(1);
        let waits = |place: usize, hold: &Hold| (place == 0 || place == last) && is_inside(hold);
        let moves = holds
            .iter()
            .enumerate()
            .filter(|(place, hold)| !waits(*place, hold));
        let inputs = moves.flat_map(|(_, hold)| run.input()[hold.samples.clone()].iter().copied());
        inputs.collect::<Vec<f64>>()
    };
    record.runs().iter().flat_map(of_run).collect()
}

/// Smallest and largest command.
pub(super) fn ends(record: &Record) -> (f64, f64) {
    extent(record.inputs()).unwrap_or((f64::INFINITY, f64::NEG_INFINITY))
}

/// By which fraction the larger of two exceeds the smaller.
pub(super) fn larger_by([a, b]: [f64; 2]) -> f64 {
    a.max(b) / a.min(b) - 1.0
}

/// "the strokes differ, 8 against 10 deg"; `unit` may be empty.
pub(super) fn strokes_differ([a, b]: [String; 2], unit: &str) -> String {
    format!("the strokes differ, {a} against {}", with_unit(b, unit))
}

/// To a thousandth.
fn rounded(x: f64) -> f64 {
    (x * 1e3).round() / 1e3
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(input: Vec<f64>) -> Motion {
        let output: Vec<f64> = (0..input.len()).map(|k| (k % 7) as f64).collect();
        Motion::of(&Record::of_run(0.01, &input, &output).unwrap())
    }

    fn square(amplitude: f64, hold: usize) -> Motion {
        of((0..400)
            .map(|k| {
                if (k / hold).is_multiple_of(2) {
                    amplitude
                } else {
                    -amplitude
                }
            })
            .collect())
    }

    #[test]
    fn motions_of_another_size_or_kind_are_distinguished() {
        let small = square(5.0, 20);
        assert!(small.is_like(&square(5.1, 20)));
        assert!(!small.is_like(&square(30.0, 20)));
        assert_eq!(
            small.difference_in_words(&square(30.0, 20), "deg"),
            "the strokes differ, ±5 against ±30 deg"
        );
        let longer = small.difference_in_words(&square(5.0, 40), "");
        assert!(
            longer.starts_with("the references differ (the first has 2 levels")
                && longer.contains("; the second has 2 levels"),
            "{longer}"
        );
        assert!(!small.is_like(&square(5.0, 40)));
        assert_eq!(
            small.difference_in_words(&small, "deg"),
            "the references differ in their strokes (both have 2 levels from -5 to +5 deg, usually held for 0.2 s)"
        );
        assert_eq!(
            small.in_words("deg"),
            "2 levels from -5 to +5 deg, usually held for 0.2 s"
        );
        let sine = of((0..400)
            .map(|k| 5.0 * (f64::from(k) * 0.05).sin())
            .collect());
        assert!(!small.is_like(&sine) && sine.is_like(&sine));
        assert_eq!(sine.in_words(""), "a smooth motion from -5 to +5");
        let stairs = of((0..400)
            .map(|k| f64::from(k / 20 % 5) * 2.5 - 5.0)
            .collect());
        assert_eq!(stairs.levels, Some(5));
        assert!(!small.is_like(&stairs));
    }

    /// Two sines that are alike in nothing: where they turn together, few values are far apart.
    #[test]
    fn a_smooth_motion_has_no_levels_and_no_holds_however_close_its_rows_are() {
        for rows in [8.0, 20.0, 100.0, 400.0] {
            let at = |k: u32| {
                let t = f64::from(k) / rows;
                25.0 * (t.sin() + (2.7 * t).sin())
            };
            let smooth = of((0..4000).map(at).collect());
            assert!(
                smooth.levels.is_none() && !smooth.held,
                "{rows}: {smooth:?}"
            );
            let rounded = of((0..4000).map(|k| (1e2 * at(k)).round() / 1e2).collect());
            assert!(
                rounded.in_words("").starts_with("a smooth motion"),
                "{rows}"
            );
        }
    }

    #[test]
    fn stairs_whose_levels_are_missed_by_a_little_are_one_motion_and_random_levels_are_none() {
        let missed = |factor: u64, by: f64| {
            let error = move |k: u64| by * ((k + 1).pow(2) * factor % 9973) as f64 / 4986.5 - by;
            let level = |k: u64| [-10.0, -5.0, 0.0, 5.0, 10.0, 5.0, 0.0, -5.0][k as usize / 20 % 8];
            of((0..640).map(|k| level(k) + error(k / 20)).collect())
        };
        for by in [0.1, 0.3, 0.5] {
            let (one, another) = (missed(3001, by), missed(4096, by));
            assert_eq!((one.levels, another.levels), (Some(5), Some(5)), "{by}");
            assert!(one.is_like(&another), "{one:?} {another:?}");
        }
        for (factor, count) in [(3001, 12), (4096, 12), (2111, 14), (777, 16), (4817, 16)] {
            let level = |k: u64| 10.0 * ((k + 1).pow(2) * factor % 9973) as f64 / 4986.5 - 10.0;
            let random = of((0..20 * count).map(|k| level(k / 20)).collect());
            // The first and the last may be waiting.
            assert!(random.levels >= Some(count as usize - 2), "{random:?}");
        }
    }

    #[test]
    fn waiting_at_neutral_before_and_after_is_no_level_of_the_motion() {
        let motion: Vec<f64> = (0..400).map(|k| [5.0, -5.0][k * k / 900 % 2]).collect();
        let wait = || vec![0.0; 50];
        let waiting = of([wait(), motion.clone(), wait()].concat());
        assert_eq!(waiting.levels, Some(2));
        assert!(waiting.is_like(&of(motion.clone())));
        // One that is visited in between is one of it.
        let visited = of([&motion[..200], &wait(), &motion[200..]].concat());
        assert_eq!(visited.levels, Some(3));
    }

    /// A shift register of five bits begins at any of its 31 states: the median of the holds is one chip or two, and the mean is the same.
    #[test]
    fn binary_sequences_of_other_seeds_are_one_motion_and_slower_ones_are_not() {
        let sequence = |seed: u32, chip: usize| {
            let step = |state: &mut u32, _| {
                let out = *state & 1;
                *state = *state >> 1 | (*state ^ *state >> 2) << 4 & 0b10000;
                Some(if out == 1 { 5.0 } else { -5.0 })
            };
            let chips: Vec<f64> = (0..31).scan(seed, step).collect();
            of((0..31 * chip).map(|k| chips[k / chip]).collect())
        };
        let all: Vec<Motion> = (1..32).map(|seed| sequence(seed, 8)).collect();
        let holds = |motion: &Motion| (100.0 * motion.hold_s).round();
        assert!(all.iter().any(|motion| holds(motion) != holds(&all[0])));
        for (a, b) in all.iter().zip(all.iter().cycle().skip(7)) {
            assert!(a.is_like(b), "{a:?} {b:?}");
        }
        assert!(!all[0].is_like(&sequence(1, 16)));
    }

    #[test]
    fn random_levels_of_other_draws_are_one_motion() {
        // 40 levels within ±10, from a multiplicative sequence; the draws reach ±9.9 and ±8.9.
        let random = |factor: u64, size: f64| {
            let level = move |k: u64| size * ((k + 1) * factor % 9973) as f64 / 4986.5 - size;
            of((0..800).map(|k| level(k / 20)).collect())
        };
        let (one, another) = (random(3001, 10.0), random(4096, 10.0));
        assert!(one.held && one.levels.is_none(), "{one:?}");
        assert!(one.is_like(&another), "{one:?} {another:?}");
        assert!(one.is_another_draw(&another) && !one.is_another_draw(&one));
        assert!(!one.is_like(&random(4096, 5.0)));
        let smooth = of((0..800)
            .map(|k| 10.0 * (f64::from(k) * 0.05).sin())
            .collect());
        assert!(!one.is_like(&smooth) && smooth.levels.is_none());
    }
}
