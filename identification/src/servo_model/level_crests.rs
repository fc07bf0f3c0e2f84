//! Crests of the output that are at one level though their commands are not: what a stop makes of a motion that never rests.
//!
//! A response that depends on frequency may do so by chance, so that this alone shows no stop: prediction decides.

use std::ops::Range;

use crate::data::column::extent;
use crate::data::{Record, Run};
use crate::numerics::median;

/// Crests that show it at least: two are level by chance.
const FEWEST: usize = 3;

/// Share of the range of the output within which crests are level.
const LEVEL: f64 = 0.02;

/// Share of the range of the command over which theirs must go: commands as level as the crests are those of a stick at its end.
const APART: f64 = 0.1;

/// Share of the way from the middle of the range to its end from which on an output belongs to the top of its crest.
const TOP: f64 = 0.75;

/// The level of the lower and of the upper crests \[output\], where they have one. The output goes the way of the command, or, of a `gain` below 0, the other way.
pub(super) fn level_crests(record: &Record, gain: f64) -> [Option<f64>; 2] {
    [-1.0, 1.0].map(|sign| {
        let crests = crests(record, sign, sign * gain.signum());
        level_of(&crests, sign, record)
    })
}

/// A stretch of outputs beyond the middle of the range.
struct Crest {
    /// The farthest command in it and in as many samples before, times the sign of the side.
    command: f64,
    /// The middle one of the outputs in the middle half of its top, times that sign: on the way there and back a stop is not reached.
    top: f64,
}

/// The crests of one side, -1 the lower and 1 the upper one, whose commands go `towards` -1 or 1.
fn crests(record: &Record, sign: f64, towards: f64) -> Vec<Crest> {
    let Some((low, high)) = extent(outputs(record)) else {
        return Vec::new();
    };
    let middle = 0.5 * sign * (low + high);
    let from = middle + TOP * 0.5 * (high - low);
    let of_run = |run: &Run<'_>| {
        let is_beyond: Vec<bool> = run.output().iter().map(|y| sign * y > middle).collect();
        let is_top = |k: &usize| sign * run.output()[*k] > from;
        let crest = |within: Range<usize>| {
            let before = within.start.saturating_sub(within.len());
            let commands = run.input()[before..within.end].iter();
            let (first, last) = (within.clone().find(is_top)?, within.rev().find(is_top)?);
            let quarter = (last + 1 - first) / 4;
            let top = run.output()[first + quarter..=last - quarter].iter();
            Some(Crest {
                command: commands.fold(f64::NEG_INFINITY, |far, u| far.max(towards * u)),
                top: median(top.map(|y| sign * y).collect())?,
            })
        };
        stretches_of(&is_beyond)
            .into_iter()
            .filter_map(crest)
            .collect::<Vec<_>>()
    };
    record.runs().iter().flat_map(of_run).collect()
}

/// The level at which the farthest crests are.
fn level_of(crests: &[Crest], sign: f64, record: &Record) -> Option<f64> {
    let (commands, outputs) = (extent(inputs(record))?, extent(outputs(record))?);
    let farthest = crests.iter().map(|crest| crest.top).reduce(f64::max)?;
    let is_level = |crest: &&Crest| crest.top > farthest - LEVEL * (outputs.1 - outputs.0);
    let mut level: Vec<&Crest> = crests.iter().filter(is_level).collect();
    let theirs = level.iter().map(|crest| crest.command);
    let (least, most) = extent(theirs)?;
    let are_apart = most - least > APART * (commands.1 - commands.0);
    if level.len() < FEWEST || !are_apart {
        return None;
    }
    // The farther the command goes, the longer the output is at a stop.
    level.sort_by(|a, b| b.command.total_cmp(&a.command));
    let under_farther = level[..level.len().div_ceil(2)].iter();
    median(under_farther.map(|crest| crest.top).collect()).map(|top| sign * top)
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
