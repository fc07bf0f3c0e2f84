//! Crests of the output that are at one level though their commands are not, or that are [cut off](super::cut_crests): what a stop makes of a motion that never rests.
//!
//! A response that depends on frequency may do so by chance, so that this alone shows no stop: prediction decides.

use std::ops::Range;

use super::cut_crests::Tops;
use crate::data::column::{extent, span};
use crate::data::{Record, Run, white_noise};
use crate::numerics::median;

/// Crests that are cut off which show it at least: two are level by chance.
const FEWEST: usize = 3;

/// Rows of the means whose largest is the top of a crest. A single row has more noise.
const MEAN_OF: usize = 3;

/// Standard deviations of the noise of such a mean within which tops are level: noise raises the largest of many means by as much.
const LEVEL: f64 = 4.0;

/// The least and the largest share of the range of the output within which tops are level, whatever the noise is.
const LEVEL_SHARES: [f64; 2] = [1e-3, 0.02];

/// Share of the range of the command over which theirs must go, the farthest and the nearest one apart: commands as level as the crests are those of a
/// stick at its end, or of one sine.
const APART: f64 = 0.05;

/// The level of the lower and of the upper crests \[output\], where they have one. The output goes the way of the command, or, of a `gain` below 0, the other way.
pub(crate) fn level_crests(record: &Record, gain: f64) -> [Option<f64>; 2] {
    [-1.0, 1.0].map(|sign| {
        let sides: Vec<OneSidedRun<'_>> = (record.runs().iter())
            .map(|run| OneSidedRun::of(run, sign))
            .collect();
        let (low, high) = extent(record.outputs())?;
        let middle = 0.5 * sign * (low + high);
        let crests = (sides.iter()).flat_map(|side| side.crests(middle, sign * gain.signum()));
        let crests: Vec<Crest<'_>> = crests.collect();
        Level::of(&crests, record)?
            .output()
            .map(|level| sign * level)
    })
}

/// One side of the motion in one run: outputs times -1 for the lower one.
struct OneSidedRun<'a> {
    commands: &'a [f64],
    outputs: Vec<f64>,
    /// The mean around each output. The first and the last have none.
    means: Vec<f64>,
}

impl<'a> OneSidedRun<'a> {
    fn of(run: &'a Run<'_>, sign: f64) -> Self {
        let outputs: Vec<f64> = run.output().iter().map(|y| sign * y).collect();
        let mut means = vec![f64::NAN; outputs.len()];
        for (of, mean) in (outputs.windows(MEAN_OF)).zip(means.iter_mut().skip(MEAN_OF / 2)) {
            *mean = of.iter().sum::<f64>() / MEAN_OF as f64;
        }
        Self {
            commands: run.input(),
            outputs,
            means,
        }
    }

    /// The stretches beyond the `middle`, where commands go `towards` -1 or 1.
    fn crests(&self, middle: f64, towards: f64) -> Vec<Crest<'_>> {
        let is_beyond: Vec<bool> = self.means.iter().map(|mean| *mean > middle).collect();
        let crest = |rows: Range<usize>| {
            let before = rows.start.saturating_sub(rows.len());
            let commands = self.commands[before..rows.end].iter();
            Crest {
                command: commands.fold(f64::NEG_INFINITY, |far, u| far.max(towards * u)),
                top: self.means[rows.clone()]
                    .iter()
                    .copied()
                    .fold(middle, f64::max),
                side: self,
                rows,
            }
        };
        stretches_of(&is_beyond).into_iter().map(crest).collect()
    }
}

/// A stretch of outputs beyond the middle of the range.
struct Crest<'a> {
    side: &'a OneSidedRun<'a>,
    rows: Range<usize>,
    /// The farthest command in it and in as many samples before, times the sign of the side.
    command: f64,
    /// The largest mean.
    top: f64,
}

impl<'a> Crest<'a> {
    /// The outputs of the top, if it is cut off.
    fn cut_off(&self, tops: &Tops) -> Option<&'a [f64]> {
        let side = self.side;
        let rows = tops.cut_off(&side.means, side.commands, self.rows.clone())?;
        // Around the corners some rows are beside it.
        let corner = rows.len() / 4;
        Some(&side.outputs[rows.start + corner..rows.end - corner])
    }
}

/// The crests at the level of the farthest one.
struct Level<'a> {
    crests: Vec<&'a Crest<'a>>,
    tops: Tops,
    /// Range of the command of the record.
    commands: f64,
}

impl<'a> Level<'a> {
    fn of(crests: &'a [Crest<'a>], record: &Record) -> Option<Self> {
        let (commands, range) = (span(record.inputs())?, span(record.outputs())?);
        let [least, most] = LEVEL_SHARES.map(|share| share * range);
        let noise = white_noise(record)? / (MEAN_OF as f64).sqrt();
        let tolerance = (LEVEL * noise).clamp(least, most);
        let farthest = crests.iter().map(|crest| crest.top).reduce(f64::max)?;
        let is_level = |crest: &&Crest<'_>| crest.top > farthest - tolerance;
        Some(Self {
            crests: crests.iter().filter(is_level).collect(),
            tops: Tops {
                farthest,
                tolerance,
                range,
                ratio: range / commands,
            },
            commands,
        })
    }

    /// The output there, times the sign of the side, if it is a stop's.
    fn output(mut self) -> Option<f64> {
        self.of_cut_off().or_else(|| self.of_apart())
    }

    /// That of crests that are cut off.
    fn of_cut_off(&self) -> Option<f64> {
        let tops: Vec<&[f64]> = (self.crests.iter())
            .filter_map(|crest| crest.cut_off(&self.tops))
            .collect();
        // Of many tops of a sine, noise makes some look so.
        let are_many = 4 * tops.len() > self.crests.len();
        (tops.len() >= FEWEST && are_many).then(|| median(tops.concat()))?
    }

    /// That of crests whose commands are apart.
    fn of_apart(&mut self) -> Option<f64> {
        let Tops {
            farthest,
            tolerance,
            ..
        } = self.tops;
        // The farther the command goes, the longer the output is at a stop.
        (self.crests).sort_by(|a, b| b.command.total_cmp(&a.command));
        // One crest that a run begins or ends with is apart from those of any sine.
        let [_, far, .., near, _] = self.crests[..] else {
            return None;
        };
        if far.command - near.command <= APART * self.commands {
            return None;
        }
        let under_farther = self.crests[..self.crests.len().div_ceil(2)].iter();
        // The top itself is raised by noise.
        let is_there =
            |row: &usize, side: &OneSidedRun<'_>| side.means[*row] > farthest - 2.0 * tolerance;
        let there = under_farther.flat_map(|crest| {
            let rows = crest.rows.clone().filter(|row| is_there(row, crest.side));
            rows.map(|row| crest.side.outputs[row])
        });
        median(there.collect())
    }
}

/// The places of `true` that follow one another.
fn stretches_of(values: &[bool]) -> Vec<Range<usize>> {
    let mut at = 0;
    let chunks = values.chunk_by(|a, b| a == b).map(|chunk| {
        at += chunk.len();
        (chunk[0], at - chunk.len()..at)
    });
    chunks
        .filter_map(|(value, place)| value.then_some(place))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;
    use rand_distr::StandardNormal;

    /// Three sines behind a lag of five samples, up to `stop`, with the gain `gain`.
    fn record(stop: f64, gain: f64) -> Record<'static> {
        let wave = |k: f64| 4.0 * ((0.031 * k).sin() + (0.053 * k + 1.0).sin() + (0.017 * k).sin());
        let input: Vec<f64> = (0..4000).map(|k| wave(f64::from(k))).collect();
        let follow = |y: &mut f64, u: &f64| {
            *y = f64::min(*y + (u - *y) / 5.0, stop);
            Some(90.0 + gain * *y)
        };
        let output: Vec<f64> = input.iter().scan(0.0, follow).collect();
        Record::of_run(0.005, input, output).unwrap()
    }

    #[test]
    fn crests_at_a_stop_are_level() {
        for gain in [1.0, 0.1] {
            let [lower, upper] = level_crests(&record(6.0, gain), gain);
            assert!((upper.unwrap() - 90.0 - 6.0 * gain).abs() < 1e-9);
            assert_eq!(lower, None);
        }
        let [lower, upper] = level_crests(&record(6.0, -1.0), -1.0);
        assert!((lower.unwrap() - 84.0).abs() < 1e-9);
        assert_eq!(upper, None);
    }

    /// A stop that few crests touch for some rows, in noise of .01.
    #[test]
    fn a_stop_that_is_touched_for_a_moment_is_at_its_level() {
        let clean = record(9.0, 1.0);
        let run = &clean.runs()[0];
        let mut random = ChaCha8Rng::seed_from_u64(3);
        let noisy = |y: &f64| y + 0.01 * random.sample::<f64, _>(StandardNormal);
        let output: Vec<f64> = run.output().iter().map(noisy).collect();
        let record = Record::of_run(0.005, run.input().to_vec(), output).unwrap();
        let [lower, upper] = level_crests(&record, 1.0);
        assert!((upper.unwrap() - 99.0).abs() < 0.01, "{upper:?}");
        assert_eq!(lower, None);
    }

    #[test]
    fn crests_of_a_servo_that_is_free_are_not() {
        assert_eq!(level_crests(&record(99.0, 1.0), 1.0), [None; 2]);
    }

    #[test]
    fn nor_are_those_of_one_command() {
        let input: Vec<f64> = (0..2000).map(|k| (0.03 * f64::from(k)).sin()).collect();
        let record = Record::of_run(0.005, input.clone(), input).unwrap();
        assert_eq!(level_crests(&record, 1.0), [None; 2]);
    }

    /// A sweep of one amplitude, from 0.3 to 4 Hz, as `servo` follows it from row to row.
    fn swept(mut servo: impl FnMut(f64) -> f64) -> Record<'static> {
        let phase = |t: f64| std::f64::consts::TAU * (0.3 + 0.5 * 3.7 * t / 20.0) * t;
        let input: Vec<f64> = (0..4000)
            .map(|k| 10.0 * phase(0.005 * f64::from(k)).sin())
            .collect();
        let output: Vec<f64> = input.iter().map(|u| servo(*u)).collect();
        Record::of_run(0.005, input, output).unwrap()
    }

    #[test]
    fn crests_of_one_command_that_are_cut_off_are_at_a_stop() {
        let mut y = 0.0;
        let record = swept(|u| {
            y = f64::clamp(y + (u - y) / 5.0, -9.0, 6.0);
            y
        });
        assert_eq!(level_crests(&record, 1.0), [Some(-9.0), Some(6.0)]);
    }

    /// Behind a sensor whose steps are a sixtieth of the motion, from a rest whose first crest is smaller.
    #[test]
    fn nor_are_those_of_one_sine_in_steps_of_a_sensor() {
        let sine = |k: u32| match f64::from(k) * 0.005 {
            t if t < 1.0 => 0.0,
            t => 3.0 * (std::f64::consts::TAU * 4.0 * t).sin(),
        };
        let input: Vec<f64> = (0..4000).map(sine).collect();
        for phase in [0.0, 0.03, 0.07] {
            let follow = |y: &mut f64, u: &f64| {
                *y += (u - *y) / 5.0;
                Some(((*y + phase) / 0.088).round() * 0.088)
            };
            let output: Vec<f64> = input.iter().scan(0.0, follow).collect();
            let record = Record::of_run(0.005, input.clone(), output).unwrap();
            assert_eq!(level_crests(&record, 1.0), [None; 2], "{phase}");
        }
    }

    /// Play or a dead band of a tenth of the sweep, a speed of half of its own, and coming to rest behind a clipped command: tops of the first are flat, of the last level.
    #[test]
    fn crests_at_which_other_servos_wait_are_not() {
        let (mut play, mut dead, mut slow, mut clipped) = (0.0, 0.0, 0.0, 0.0);
        let records = [
            swept(|u| {
                play = f64::clamp(play, u - 1.0, u + 1.0);
                play
            }),
            swept(|u| {
                let error: f64 = u - dead;
                dead += (error.abs() - 1.0).max(0.0).copysign(error) / 5.0;
                dead
            }),
            swept(|u| {
                slow += ((u - slow) / 5.0).clamp(-0.3, 0.3);
                slow
            }),
            swept(|u| {
                clipped += (u.clamp(-6.0, 6.0) - clipped) / 20.0;
                clipped
            }),
        ];
        for record in records {
            assert_eq!(level_crests(&record, 1.0), [None; 2]);
        }
    }
}
