//! Whether the rests of held commands are flat at an end, as at a stop.
//!
//! At rest a linear servo is a straight line of its commands, and in each run a parallel one, since the zero of a sensor may move between
//! runs. From a stop on the line is flat, be it under one level alone or under many. Where the ends fall short a little at a time, as with a
//! linkage or a soft gain, a polynomial describes the rests better; where commands are reached from both sides with friction or play,
//! others are as far from their line as the last.

use std::ops::Range;

use super::moves_beyond::moves_beyond;
use super::rests::{FEWEST, Rest, rests};
use super::split::Split;
use super::split_squares::SplitSquares;
use crate::data::column::span;
use crate::data::{Record, sensor_step};
use crate::numerics::median;

/// Share of the range of the commands over which the line must go: two of six levels do, a few neighbours show no slope.
const LINE: f64 = 0.15;

/// A stop is passed where more than the second share of the samples lies beyond it by more than the first share of the travel: neither noise nor
/// glitches nor what gives at a stop are so far and so many.
const PASSED: (f64, f64) = (0.1, 0.1);

/// Most places at which an end is looked for: of more commands, not all are tried.
const PLACES: usize = 50;

/// Commands at which the output rests at one angle, beside those at which it follows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct TravelEnd {
    /// Where it rests \[output\].
    pub(crate) rest: f64,
    /// The command from which on it does, and the last one \[input\].
    pub(crate) commands: (f64, f64),
    /// How many commands between the two rest there.
    pub(crate) count: usize,
    /// Whether these commands show an end: several at one angle, or one that is held at an angle short of the line of the others.
    pub(crate) is_shown: bool,
}

impl TravelEnd {
    /// Whether several commands end there, each further out than the one before. What holds the servo short of one command may be a load or friction.
    pub(crate) fn is_of_several_commands(&self) -> bool {
        self.is_shown && self.commands.0 != self.commands.1
    }

    /// The ends under the highest and the lowest commands that are held, by the rests alone. Of a sensor with steps, what is short by no more
    /// is rounded.
    pub(crate) fn of_rests(record: &Record) -> [Option<Self>; 2] {
        of_rests(&rests(record), sensor_step(record).unwrap_or_default())
            .map(|end| end.filter(|end| !end.is_passed(record)))
    }

    /// Whether the output goes on beyond it, as it does where short holds of a motion that goes on look like rests. One that a command alone shows may be a load or friction.
    fn is_passed(&self, record: &Record) -> bool {
        let present = || record.outputs().filter(|y| !y.is_nan());
        let (Some(travel), count) = (span(present()), present().count() as f64) else {
            return false;
        };
        let outwards = (self.rest - present().sum::<f64>() / count).signum();
        let is_far = |y: &f64| outwards * (y - self.rest) > PASSED.0 * travel;
        let is_far_often = present().filter(is_far).count() as f64 > PASSED.1 * count;
        is_far_often
            || !self.is_of_several_commands() && moves_beyond(record, [self.commands.1, self.rest])
    }
}

/// The outputs at which the rests of `record` are flat, as at stops, by the rests alone: one, two or none.
#[must_use]
pub fn stops_of_rests(record: &Record) -> Vec<f64> {
    let ends = TravelEnd::of_rests(record).into_iter().flatten();
    ends.map(|end| end.rest).collect()
}

/// Those among them that several commands show.
pub(crate) fn stops_of_several_commands(record: &Record) -> Vec<f64> {
    let ends = TravelEnd::of_rests(record).into_iter().flatten();
    let ends = ends.filter(TravelEnd::is_of_several_commands);
    ends.map(|end| end.rest).collect()
}

fn of_rests(rests: &[Rest], step: f64) -> [Option<TravelEnd>; 2] {
    let places = places(rests);
    let squares = SplitSquares::new(rests, &places);
    // Two first: a line that has a stop of its own falls short of nothing.
    let found = [&[1, 0][..], &[1], &[0]]
        .into_iter()
        .filter_map(|sides| best_split(rests, (&places, &squares), sides))
        .find(|split| split.is_flat(rests, step));
    found.map_or([None; 2], |split| {
        [1, 0].map(|side| end(&split, rests, side))
    })
}

/// Where the command changes, among rests by the command; of many places some.
fn places(rests: &[Rest]) -> Vec<usize> {
    let changes = (1..rests.len()).filter(|k| rests[k - 1].command < rests[*k].command);
    let all: Vec<usize> = changes.collect();
    let every = 1 + all.len() / PLACES;
    all.into_iter().step_by(every).collect()
}

/// The line between the ends `sides` (0 the lower, 1 the upper one) that leaves least.
fn best_split(
    rests: &[Rest],
    (places, squares): (&[usize], &SplitSquares),
    sides: &[usize],
) -> Option<Split> {
    let all = (vec![0], vec![rests.len()]);
    let starts = if sides.contains(&0) { places } else { &all.0 };
    let ends = if sides.contains(&1) { places } else { &all.1 };
    let inner = starts
        .iter()
        .flat_map(|start| ends.iter().map(move |end| *start..*end));
    let lines = inner.filter(|inner| is_line(rests, inner)).collect();
    let worth_a_pass = squares.least(lines).into_iter();
    worth_a_pass
        .filter_map(|inner| Split::of(rests, inner))
        .min_by(|a, b| a.square.total_cmp(&b.square))
}

/// The end beyond one side of the line, at the common offset.
fn end(split: &Split, rests: &[Rest], side: usize) -> Option<TravelEnd> {
    let mut end = split.beyond(rests, side);
    if side == 0 {
        end.reverse();
    }
    let (first, last) = (end.first()?, end.last()?);
    let moved = split.moved()?;
    // A mean is moved by a hold that ends just before the stop.
    let rest = median(
        end.iter()
            .map(|rest| rest.output - moved[rest.run])
            .collect(),
    )?;
    let mut commands: Vec<f64> = end.iter().map(|rest| rest.command).collect();
    commands.dedup();
    Some(TravelEnd {
        rest,
        commands: (first.command, last.command),
        count: commands.len(),
        is_shown: true,
    })
}

/// Whether `inner` are rests of a line, with enough commands in it and beside it.
fn is_line(rests: &[Rest], inner: &Range<usize>) -> bool {
    let Some([first, .., last]) = rests.get(inner.clone()) else {
        return false;
    };
    let range = rests[rests.len() - 1].command - rests[0].command;
    let few = |rests: &[Rest]| {
        let commands = rests.chunk_by(|a, b| a.command == b.command);
        commands.take(FEWEST).count()
    };
    // Those of the line, and one fewer of each end that there is.
    let ends = [&rests[..inner.start], &rests[inner.end..]];
    let beyond = ends.map(|end| few(end).saturating_sub(1));
    last.command - first.command > LINE * range
        && few(&rests[inner.clone()]) + beyond[0] + beyond[1] >= FEWEST
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    /// A lag of 10 samples under random levels that are held for 100, whose output has its ends at `ends`.
    fn found(ends: (f64, f64), follows: impl Fn(f64) -> f64) -> Option<TravelEnd> {
        let mut random = ChaCha8Rng::seed_from_u64(3);
        let levels: Vec<f64> = (0..40).map(|_| random.random_range(-20.0..20.0)).collect();
        let input: Vec<f64> = levels.iter().flat_map(|level| [*level; 100]).collect();
        let mut y = 0.0;
        let output: Vec<f64> = input
            .iter()
            .map(|u| {
                y += (follows(*u) - y) / 10.0;
                y = f64::clamp(y, ends.0, ends.1);
                y + random.random_range(-0.1..0.1)
            })
            .collect();
        let ends = TravelEnd::of_rests(&Record::of_run(0.01, &input, &output).unwrap());
        ends.into_iter().flatten().next()
    }

    /// Random levels behind a lag under noise, of a servo that moves freely or stops at 12, in steps of the sensor. None of the 40 free servos
    /// may be found, since what rounding can do is bounded; of those that stop at three fifths of the range all are, in steps of 2.
    #[test]
    fn a_coarse_sensor_is_no_stop() {
        let rounded = |seed: u64, step: f64, end: f64| {
            let mut random = ChaCha8Rng::seed_from_u64(seed);
            let levels: Vec<f64> = (0..60).map(|_| random.random_range(-20.0..20.0)).collect();
            let input: Vec<f64> = levels.iter().flat_map(|level| [*level; 50]).collect();
            let mut y = 0.0;
            let mut seen = |u: &f64| {
                y = f64::min(y + (u - y) / 5.0, end);
                ((y + random.random_range(-0.1..0.1)) / step).round() * step
            };
            let output: Vec<f64> = input.iter().map(&mut seen).collect();
            let record = Record::of_run(0.01, &input, &output).unwrap();
            TravelEnd::of_rests(&record).into_iter().flatten().next()
        };
        for seed in 0..10 {
            for step in [2.0, 3.0, 4.0, 5.0] {
                assert_eq!(rounded(seed, step, 99.0), None, "seed {seed}, step {step}");
            }
            assert!(rounded(seed, 2.0, 12.0).is_some(), "seed {seed}");
        }
    }

    #[test]
    fn a_stop_within_the_range_is_found_at_either_end_and_none_is_elsewhere() {
        let none = (f64::NEG_INFINITY, f64::INFINITY);
        let upper = found((-40.0, 12.0), |u| u).unwrap();
        assert!((upper.rest - 12.0).abs() < 0.05, "{upper:?}");
        assert!(upper.commands.0 > 12.0 && upper.commands.1 > 17.0 && upper.count >= 5);
        let lower = found((-6.0, 40.0), |u| 0.5 * u).unwrap_or_else(|| panic!("a lower stop"));
        assert!(
            (lower.rest + 6.0).abs() < 0.05 && lower.commands.1 < -17.0,
            "{lower:?}"
        );
        assert_eq!(found(none, |u| u), None);
        // A gain that falls to a third, and a dead band of 2 units.
        assert_eq!(
            found(none, |u| if u > 10.0 { 10.0 + (u - 10.0) / 3.0 } else { u }),
            None
        );
        assert_eq!(found(none, |u| (u / 2.0).round() * 2.0), None);
    }

    /// Six levels from -10 to 10 in random order, each visited six times, in each of three runs; `output` has the level, the one before and
    /// noise within ±0.05. Each run has an offset of its own besides.
    fn visits(seed: u64, offsets: [f64; 3], output: impl Fn(f64, f64, f64) -> f64) -> Vec<Rest> {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut rests = Vec::new();
        for (run, offset) in offsets.iter().enumerate() {
            let mut left: Vec<f64> = (0..36).map(|k| f64::from(k % 6) * 4.0 - 10.0).collect();
            let mut before = 0.0;
            while !left.is_empty() {
                let command = left.swap_remove(random.random_range(0..left.len()));
                let output = offset + output(command, before, random.random_range(-0.05..0.05));
                rests.push(Rest {
                    run,
                    command,
                    output,
                });
                before = command;
            }
        }
        rests.sort_by(|a, b| a.command.total_cmp(&b.command));
        rests
    }

    const OFFSETS: [f64; 3] = [-1.0, 0.3, 1.2];

    #[test]
    fn no_line_leaves_less_than_the_one_of_those_that_are_worth_a_pass() {
        for seed in 0..20 {
            for noisy in [0.0, 1.0] {
                let rests = visits(seed, OFFSETS, |level, _, noise| {
                    level.clamp(-5.0, 9.8) + noisy * noise
                });
                let places = places(&rests);
                let squares = SplitSquares::new(&rests, &places);
                let pairs = places
                    .iter()
                    .flat_map(|a| places.iter().map(move |b| *a..*b));
                let lines = pairs.filter(|line| is_line(&rests, line));
                let all = lines.filter_map(|line| Split::of(&rests, line));
                let least = all.min_by(|a, b| a.square.total_cmp(&b.square)).unwrap();
                let found = best_split(&rests, (&places, &squares), &[1, 0]).unwrap();
                assert_eq!(found.inner, least.inner, "seed {seed}");
            }
        }
    }

    #[test]
    fn levels_beyond_a_stop_are_short_of_the_line_whatever_the_offsets_of_runs() {
        let at = |found: Option<TravelEnd>, rest: f64, commands: (f64, f64)| {
            let found = found.unwrap_or_else(|| panic!("a stop at {rest}"));
            // 0.5 / 3 is the mean of the offsets.
            assert!((found.rest - rest - 0.5 / 3.0).abs() < 0.05, "{found:?}");
            assert_eq!(found.commands, commands);
        };
        for seed in 0..20 {
            let one = of_rests(
                &visits(seed, OFFSETS, |level, _, noise| level.min(9.8) + noise),
                0.0,
            );
            at(one[0], 9.8, (10.0, 10.0));
            let two = of_rests(
                &visits(seed, OFFSETS, |level, _, noise| {
                    level.clamp(-9.2, 4.0) + noise
                }),
                0.0,
            );
            at(two[0], 4.0, (6.0, 10.0));
            at(two[1], -9.2, (-10.0, -10.0));
            assert!(one[1].is_none());
            // Two levels follow.
            let wide = visits(seed, OFFSETS, |level, _, noise| {
                level.clamp(-5.0, 2.5) + noise
            });
            let wide = of_rests(&wide, 0.0);
            at(wide[0], 2.5, (6.0, 10.0));
            at(wide[1], -5.0, (-6.0, -10.0));
        }
        // Short by 0.8: a sensor with steps of 0.5 shows it, one with steps of 1 may have rounded.
        let rests = visits(2, OFFSETS, |level, _, noise| level.clamp(-9.2, 9.2) + noise);
        assert!(of_rests(&rests, 0.5)[0].is_some());
        assert_eq!(of_rests(&rests, 1.0), [None; 2]);
    }

    #[test]
    fn noise_play_and_gains_that_fall_are_no_stop() {
        type Curve = fn(f64, f64, f64) -> f64;
        let curves: [Curve; 6] = [
            |level, _, noise| level + noise,
            |level, _, noise| level - 0.01 * level * level + noise,
            |level, _, noise| level - 1e-3 * level.powi(3) + noise,
            |level, _, noise| 30.0 * (level / 30.0).sin() + noise,
            // Play or friction: short of the level from either side.
            |level, before, noise| level + 0.2 * (before - level).signum() + noise,
            |level, before, noise| level + 0.6 * (before - level).signum() + 0.1 * noise,
        ];
        for (number, curve) in curves.iter().enumerate() {
            for seed in 0..100 {
                let found = of_rests(&visits(seed, OFFSETS, curve), 0.0);
                assert_eq!(found, [None; 2], "curve {number}, seed {seed}");
            }
        }
    }

    /// What is not noise but the same at each visit of a level, as of a linkage, may pass for a stop under few levels: in a fifth of these records.
    /// Where an end is hardly short it does not.
    #[test]
    fn few_levels_that_are_off_alike_at_each_visit_may_pass_for_a_stop() {
        let is_stop = |seed: u64| {
            let mut random = ChaCha8Rng::seed_from_u64(seed);
            let mut rests = Vec::new();
            for command in [-10.0, -10.0 / 3.0, 10.0 / 3.0, 10.0] {
                let off = random.random_range(-0.173..0.173);
                for _ in 0..8 {
                    let noise = random.random_range(-0.05..0.05);
                    let output = command + off + noise;
                    rests.push(Rest {
                        run: 0,
                        command,
                        output,
                    });
                }
            }
            of_rests(&rests, 0.0) != [None; 2]
        };
        let stops = (0..400).filter(|seed| is_stop(*seed)).count();
        // 84 of 400; 99 where an end may be short by however little.
        assert!(stops < 90, "{stops}");
    }

    /// Levels of which the upper ones rest at 0.5, and a motion that goes on up to an angle.
    #[test]
    fn a_stop_that_the_output_passes_is_none() {
        let found = |farthest: f64| {
            let (mut input, mut output) = (Vec::new(), vec![0.0; 3]);
            for visit in 0..28 {
                let level = f64::from(visit * 3 % 7 - 3);
                input.extend([level; 40]);
                output.extend([f64::min(level, 0.5); 40]);
            }
            for k in 0..600 {
                let command = 3.0 * (0.1 * f64::from(k)).sin();
                input.push(command);
                output.push(command.min(farthest));
            }
            output.truncate(input.len());
            stops_of_rests(&Record::of_run(0.005, input, output).unwrap())
        };
        assert_eq!(found(0.5), [0.5]);
        assert_eq!(found(3.0), [0.0; 0]);
    }

    /// Levels up to one that is hardly beyond the stop at 6, where some holds end before the servo, which comes there slowly, is.
    #[test]
    fn holds_that_end_before_the_stop_do_not_move_it() {
        let levels = [
            -9.0, 6.1, -3.0, 9.0, 0.0, 8.0, 3.0, 6.1, -6.0, 8.5, -9.0, 6.1,
        ];
        let mut y = 0.0;
        let mut random = ChaCha8Rng::seed_from_u64(3);
        let input: Vec<f64> = (0..3840).map(|k| levels[k / 80 % 12]).collect();
        let follow = |u: &f64| {
            y = f64::min(y + (u - y) / 20.0, 6.0);
            y + random.random_range(-0.01..0.01)
        };
        let output: Vec<f64> = input.iter().map(follow).collect();
        let found = stops_of_rests(&Record::of_run(0.01, input, output).unwrap());
        assert!((found[0] - 6.0).abs() < 0.003, "{found:?}");
    }
}
