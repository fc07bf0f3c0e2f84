//! Crests of the output that are at one level though their commands are not: what a stop makes of a motion that never rests.
//!
//! A response that depends on frequency may do so by chance, so that this alone shows no stop: prediction decides.

use std::ops::Range;

use crate::data::column::extent;
use crate::data::{Record, Run};
use crate::numerics::median;

/// Crests that show it at least: two are level by chance.
const FEWEST: usize = 3;

/// Rows of the means whose largest is the top of a crest. A single row has more noise.
const MEAN_OF: usize = 3;

/// Standard deviations of the noise of such a mean within which tops are level: noise raises the largest of many means by as much.
const LEVEL: f64 = 4.0;

/// The least and the largest share of the range of the output within which tops are level, whatever the noise is.
const LEVEL_SHARES: [f64; 2] = [1e-3, 0.02];

/// Share of the range of the command over which theirs must go: commands as level as the crests are those of a stick at its end.
const APART: f64 = 0.05;

/// The level of the lower and of the upper crests \[output\], where they have one. The output goes the way of the command, or, of a `gain` below 0, the other way.
pub(crate) fn level_crests(record: &Record, gain: f64) -> [Option<f64>; 2] {
    [-1.0, 1.0].map(|sign| {
        let crests = crests(record, sign, sign * gain.signum());
        level_of(&crests, record).map(|level| sign * level)
    })
}

/// A stretch of outputs beyond the middle of the range.
struct Crest {
    /// The farthest command in it and in as many samples before, times the sign of the side.
    command: f64,
    /// The largest mean, times that sign.
    top: f64,
    /// Each mean with the output in its middle, times that sign.
    means: Vec<(f64, f64)>,
}

/// The crests of one side, -1 the lower and 1 the upper one, whose commands go `towards` -1 or 1.
fn crests(record: &Record, sign: f64, towards: f64) -> Vec<Crest> {
    let Some((low, high)) = extent(outputs(record)) else {
        return Vec::new();
    };
    let middle = 0.5 * sign * (low + high);
    let of_run = |run: &Run<'_>| {
        let means = means(run.output(), sign);
        let is_beyond: Vec<bool> = means.iter().map(|(mean, _)| *mean > middle).collect();
        let crest = |within: Range<usize>| {
            let before = within.start.saturating_sub(within.len());
            let commands = run.input()[before..within.end].iter();
            let means = means[within].to_vec();
            Crest {
                command: commands.fold(f64::NEG_INFINITY, |far, u| far.max(towards * u)),
                top: means.iter().map(|(mean, _)| *mean).fold(middle, f64::max),
                means,
            }
        };
        let found = stretches_of(&is_beyond).into_iter().map(crest);
        found.collect::<Vec<_>>()
    };
    record.runs().iter().flat_map(of_run).collect()
}

/// The mean around each output and the output itself, times `sign`. The first and the last have no mean.
fn means(outputs: &[f64], sign: f64) -> Vec<(f64, f64)> {
    let mut means: Vec<(f64, f64)> = outputs.iter().map(|y| (f64::NAN, sign * y)).collect();
    for (of, mean) in outputs
        .windows(MEAN_OF)
        .zip(means.iter_mut().skip(MEAN_OF / 2))
    {
        mean.0 = sign * of.iter().sum::<f64>() / MEAN_OF as f64;
    }
    means
}

/// The level at which the farthest crests are, times the sign of their side.
fn level_of(crests: &[Crest], record: &Record) -> Option<f64> {
    let (commands, outputs) = (extent(inputs(record))?, extent(outputs(record))?);
    let range = outputs.1 - outputs.0;
    let [least, most] = LEVEL_SHARES.map(|share| share * range);
    let noise = noise(record)? / (MEAN_OF as f64).sqrt();
    let tolerance = (LEVEL * noise).clamp(least, most);
    let farthest = crests.iter().map(|crest| crest.top).reduce(f64::max)?;
    let is_level = |crest: &&Crest| crest.top > farthest - tolerance;
    let mut level: Vec<&Crest> = crests.iter().filter(is_level).collect();
    let (least, most) = extent(level.iter().map(|crest| crest.command))?;
    let are_apart = most - least > APART * (commands.1 - commands.0);
    if level.len() < FEWEST || !are_apart {
        return None;
    }
    // The farther the command goes, the longer the output is at a stop.
    level.sort_by(|a, b| b.command.total_cmp(&a.command));
    let under_farther = level[..level.len().div_ceil(2)].iter();
    // The top itself is raised by noise.
    let is_there = |(mean, _): &&(f64, f64)| *mean > farthest - 2.0 * tolerance;
    let there = under_farther.flat_map(|crest| crest.means.iter().filter(is_there));
    median(there.map(|(_, output)| *output).collect())
}

/// Standard deviation of white noise with the fourth differences of the outputs, which motion hardly has.
fn noise(record: &Record) -> Option<f64> {
    /// The median size of a normal variable, and the root of 1 + 16 + 36 + 16 + 1.
    const OF_MEDIAN: f64 = 0.674_490;
    const OF_DIFFERENCE: f64 = 8.366_600;
    let of_run = |run: &Run<'_>| -> Vec<f64> {
        let fives = run.output().windows(5);
        let sizes = fives.map(|y| (y[0] - 4.0 * y[1] + 6.0 * y[2] - 4.0 * y[3] + y[4]).abs());
        sizes.filter(|size| !size.is_nan()).collect()
    };
    let sizes = record.runs().iter().flat_map(of_run).collect();
    median(sizes).map(|size| size / (OF_MEDIAN * OF_DIFFERENCE))
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

fn inputs(record: &Record) -> impl Iterator<Item = f64> {
    record.runs().iter().flat_map(|run| run.input()).copied()
}

fn outputs(record: &Record) -> impl Iterator<Item = f64> {
    record.runs().iter().flat_map(|run| run.output()).copied()
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
}
