//! A servo that stops following its command within a run: switched off, unplugged, or jammed from then on.
//!
//! The output is looked at in blocks, whose means have little noise. From some block to the end of the run they all lie close together,
//! while the input goes on with strokes as long as those that the output has followed before. A servo that is too slow
//! for shorter and shorter strokes is none of these.
//!
//! A model of such a record is one of two servos, of which one does not move: it has no bounds.

use crate::data::column::{mean, span};
use crate::data::{Record, Run};
use crate::thresholds::{
    STANDSTILL_AS_LONG, STANDSTILL_FOLLOWED, STANDSTILL_PART, STANDSTILL_STROKE,
    STANDSTILL_STROKES, STANDSTILL_TRAVEL,
};
use std::ops::Range;

/// Blocks of a run, at most.
const BLOCKS: usize = 400;

/// Delays at which the input may explain the output within blocks, in blocks.
const DELAYS: usize = 4;

/// Share of the output's variance within blocks that the input explains where the servo follows it. Under square waves, noise alone comes at the best
/// of so many delays to 0.06 to 0.22 in one of a hundred parts of 80 to 200 samples, the shortest that count; white, or AR(1) that keeps 0.9.
const FOLLOWS: f64 = 0.25;

/// Where the servo stops.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ServoStopped {
    /// The run, from 1, where there are several.
    pub run: Option<usize>,
    /// Time from the start of the run \[s\].
    pub at_s: f64,
}

impl ServoStopped {
    /// The first run of the record whose output stands still from some time on while its input goes on.
    #[must_use]
    pub fn of(record: &Record) -> Option<Self> {
        let stopped = |(number, run)| Some((number, stopped_at(run)?));
        let (number, sample) = (1..).zip(record.runs()).find_map(stopped)?;
        Some(Self {
            run: (record.runs().len() > 1).then_some(number),
            at_s: sample as f64 * record.sample_period_s(),
        })
    }

    /// What happened, as one sentence.
    #[must_use]
    pub fn in_words(&self) -> String {
        let run = self
            .run
            .map_or(String::new(), |run| format!(" of run {run}"));
        format!(
            "From {:.2} s{run} on the output stands still although the input goes on: the servo was switched off, unplugged or jammed then, \
             or the sensor's magnet came loose.",
            self.at_s
        )
    }
}

/// The sample from which on the output stands still, where it should have moved.
fn stopped_at(run: &Run<'_>) -> Option<usize> {
    let size = run.len().div_ceil(BLOCKS).max(1);
    let means: Vec<f64> = run.output().chunks(size).filter_map(mean).collect();
    if means.len() * size < run.len() / 2 {
        return None; // Most of it is missing.
    }
    let travel = span(run.output().chunks(size).filter_map(mean))?;
    let strokes = strokes(run.input())?;
    let still_from = still_from(run, size, STANDSTILL_TRAVEL * travel)?;
    let (before, after) = (still_from, run.len().saturating_sub(still_from));
    let part = |samples: usize| samples as f64 >= STANDSTILL_PART * run.len() as f64;
    let (early, late) = strokes.split_at(strokes.partition_point(|at| *at < still_from));
    let longest = between(late).map(|stroke| stroke.len()).max()?;
    let followed = |stroke: Range<usize>| {
        let parts = run.output().get(stroke)?.chunks(size).filter_map(mean);
        Some(span(parts)? >= STANDSTILL_FOLLOWED * travel)
    };
    let shortest = between(early)
        .filter(|stroke| followed(stroke.clone()) == Some(true))
        .map(|stroke| stroke.len())
        .min()?;
    let as_long = longest as f64 >= STANDSTILL_AS_LONG * shortest as f64;
    let stands = part(before) && part(after) && late.len() >= STANDSTILL_STROKES && as_long;
    (stands && !follows(run, still_from, size)).then_some(still_from)
}

/// Whether the output follows the input from sample `from` on within blocks of this size, whose means do not show what is quicker than they: the input
/// explains a part of it at some delay of a few blocks.
fn follows(run: &Run<'_>, from: usize, size: usize) -> bool {
    let within_blocks = |column: &[f64]| -> Vec<f64> {
        let blocks = column.chunks(size).flat_map(|block| {
            let mean = mean(block).unwrap_or(f64::NAN);
            block.iter().map(move |value| value - mean)
        });
        blocks.collect()
    };
    let [input, output] = [run.input(), run.output()].map(within_blocks);
    let explained = |delay: usize| {
        let late =
            (from..output.len()).filter_map(|k| Some((output[k], input[k.checked_sub(delay)?])));
        let known = late.filter(|(y, u)| !(y + u).is_nan());
        let [yy, uu, yu] = known.fold([0.0; 3], |[yy, uu, yu], (y, u)| {
            [yy + y * y, uu + u * u, yu + y * u]
        });
        // Of an output that does not move at all nothing is explained.
        yu * yu > FOLLOWS * yy * uu
    };
    (0..DELAYS * size).any(explained)
}

/// The samples from each stroke to the next.
fn between(strokes: &[usize]) -> impl Iterator<Item = Range<usize>> {
    let later = strokes.iter().skip(1);
    strokes.iter().zip(later).map(|(from, to)| *from..*to)
}

/// The sample from which on the output keeps within this travel.
fn still_from(run: &Run<'_>, size: usize, travel: f64) -> Option<usize> {
    let (mut low, mut high) = (f64::MAX, f64::MIN);
    let blocks: Vec<&[f64]> = run.output().chunks(size).collect();
    let moving = blocks.iter().rposition(|block| {
        if let Some(mean) = mean(block) {
            (low, high) = (low.min(mean), high.max(mean));
        }
        high - low > travel
    })?;
    Some((moving + 1) * size)
}

/// The samples at which the input has moved by [`STANDSTILL_STROKE`] of its travel since the one before.
fn strokes(input: &[f64]) -> Option<Vec<usize>> {
    let stroke = STANDSTILL_STROKE * span(input.iter().copied())?;
    let mut from = input.iter().copied().find(|u| u.is_finite())?;
    let has_moved = |(k, u): (usize, &f64)| {
        let is_far = (u - from).abs() > stroke;
        is_far.then(|| {
            from = *u;
            k
        })
    };
    Some(input.iter().enumerate().filter_map(has_moved).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A lag of `time` samples under these commands, which stands still from `off` on; with noise of 1 % of the travel.
    fn record(commands: &[f64], time: f64, off: usize) -> Record<'static> {
        let mut position = commands[0];
        let output = commands.iter().enumerate().map(|(k, command)| {
            if k < off {
                position += (command - position) / time;
            }
            let noise = ((k * k * 7919) % 101) as f64 / 100.0 - 0.5;
            position + 0.1 * noise
        });
        let output: Vec<f64> = output.collect();
        Record::of_run(0.01, commands.to_vec(), output).unwrap()
    }

    fn square(length: usize, hold: impl Fn(usize) -> usize) -> Vec<f64> {
        let (mut commands, mut level) = (Vec::new(), 5.0);
        while commands.len() < length {
            let hold = hold(commands.len());
            commands.extend(std::iter::repeat_n(level, hold));
            level = -level;
        }
        commands
    }

    #[test]
    fn a_servo_that_is_switched_off_has_a_time() {
        let steady = square(2_000, |_| 50);
        let found = ServoStopped::of(&record(&steady, 5.0, 1_020)).unwrap();
        // The end of the last motion: it is switched off while it is at rest.
        assert_eq!(found.at_s, 10.1);
        let words = found.in_words();
        assert!(words.starts_with("From 10.10 s on"), "{words}");
        let shorter = square(2_000, |k| 80 - 70 * k / 2_000);
        let found = ServoStopped::of(&record(&shorter, 5.0, 1_000)).unwrap();
        assert!((10.0..10.6).contains(&found.at_s), "{}", found.at_s);
    }

    #[test]
    fn a_servo_that_dies_under_stairs_has_a_time() {
        // To any of six levels, none of them the last.
        let level = |k: usize| (k * k + k / 3) % 6;
        let stairs: Vec<f64> = (0..2_000).map(|k| level(k / 50) as f64 - 2.5).collect();
        let found = ServoStopped::of(&record(&stairs, 5.0, 1_200)).unwrap();
        assert!((11.5..12.1).contains(&found.at_s), "{}", found.at_s);
        assert_eq!(ServoStopped::of(&record(&stairs, 5.0, usize::MAX)), None);
    }

    #[test]
    fn a_servo_that_moves_rests_or_is_too_slow_has_none() {
        let steady = square(2_000, |_| 50);
        assert_eq!(ServoStopped::of(&record(&steady, 5.0, usize::MAX)), None);
        let resting = [&steady[..1_000], &[5.0; 1_000]].concat();
        assert_eq!(ServoStopped::of(&record(&resting, 5.0, usize::MAX)), None);
        // From slow strokes to such as it cannot follow at all.
        let sweep: Vec<f64> = (0..6_000)
            .map(|k| 5.0 * (0.002 * f64::from(k) + 2e-5 * f64::from(k * k)).sin())
            .collect();
        assert_eq!(ServoStopped::of(&record(&sweep, 60.0, usize::MAX)), None);
        // It never moved: that is another finding.
        assert_eq!(ServoStopped::of(&record(&steady, 5.0, 0)), None);
    }

    /// From 0.2 to 15 Hz in 20 s, in rows of 5 ms: the last strokes are shorter than a block, whose mean does not show them.
    #[test]
    fn a_servo_that_follows_a_quick_sweep_has_none() {
        let time = |k: u32| 0.005 * f64::from(k);
        let turns = |t: f64| 0.2 * t + 0.37 * t * t;
        let sweep: Vec<f64> = (0..4_000)
            .map(|k| 10.0 * (std::f64::consts::TAU * turns(time(k))).sin())
            .collect();
        let (mut position, mut speed) = (0.0, 0.0);
        let output = (0..sweep.len()).map(|k| {
            let command = sweep[k.saturating_sub(3)];
            speed += 0.005 * (32.0 * 32.0 * (command - position) - 1.46 * 32.0 * speed);
            position += 0.005 * speed;
            position + 0.1 * (((k * k * 7919) % 101) as f64 / 100.0 - 0.5)
        });
        let output: Vec<f64> = output.collect();
        let still = |output: Vec<f64>| {
            ServoStopped::of(&Record::of_run(0.005, sweep.clone(), output).unwrap())
        };
        assert_eq!(still(output.clone()), None);
        let last = |k: usize| output[k.min(2_400)] + 0.1 * (k % 7) as f64;
        let found = still((0..output.len()).map(last).collect());
        assert!(found.is_some_and(|found| found.at_s > 11.0), "{found:?}");
    }
}
