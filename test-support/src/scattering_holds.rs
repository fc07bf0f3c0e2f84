//! Recordings in which something differs from hold to hold: the time at which a command takes effect, or what was written of it.

use rand::RngExt;
use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;
use servoid_identification::{Options, Record};

use crate::coverage::{LONGEST_TRUTH, Line, measure_trials};
use crate::plants::{normal, random};
use crate::trial::Trial;

/// Time between rows \[s\].
const PERIOD: f64 = 0.005;

/// Time constant of the servo, a lag \[s\].
const LAG: f64 = 0.04;

/// Levels of a recording, within this of zero.
const HOLDS: usize = 60;
const LARGEST: f64 = 5.0;

/// What differs from hold to hold.
#[derive(Debug, Clone, Copy)]
pub struct ScatteringHolds {
    /// Each command takes effect after a wait of its own of up to this \[s\].
    pub frame: f64,
    /// Commands are written in steps of this; the servo gets finer ones.
    pub written: f64,
    /// Levels to choose from; any, where there are none.
    pub levels: Option<usize>,
    /// Whether the levels follow each other in one order, each held for 0.15 to 0.25 s, as long as the servo takes; else they are held for 0.3 to 0.5 s.
    pub in_order: bool,
    /// Standard deviation of white noise.
    pub noise: f64,
}

impl ScatteringHolds {
    /// Nothing differs.
    pub const NONE: Self = Self {
        frame: 0.0,
        written: 0.0,
        levels: None,
        in_order: false,
        noise: 0.025,
    };

    /// The first columns of a line.
    #[must_use]
    pub fn label(&self) -> String {
        let levels = self
            .levels
            .map_or_else(|| "any".to_owned(), |count| count.to_string());
        let order = if self.in_order { ", in order" } else { "" };
        let (frame, written) = (1e3 * self.frame, self.written);
        format!("| {frame} | {written} | {levels}{order} | {} |", self.noise)
    }

    /// How often bounds hold the mean answer in `runs` recordings, which differ in their seeds.
    #[must_use]
    pub fn measure(&self, runs: usize) -> Line {
        measure_trials(self.label(), runs, &Options::default(), |run| {
            self.trial(run as u64)
        })
    }

    /// The recording of a seed. Its truth is the mean answer over all waits.
    #[must_use]
    pub fn trial(&self, seed: u64) -> Trial {
        let rows = (0..LONGEST_TRUTH as u32).map(f64::from);
        Trial {
            record: self.record(&mut random(seed)),
            truth: rows.map(|row| self.mean_answer(PERIOD * row)).collect(),
        }
    }

    fn mean_answer(&self, time: f64) -> f64 {
        let waits = (0..100).map(|k| (f64::from(k) + 0.5) / 100.0 * self.frame);
        waits.map(|wait| answer(time - wait)).sum::<f64>() / 100.0
    }

    fn record(&self, random: &mut ChaCha8Rng) -> Record<'static> {
        let level = |random: &mut ChaCha8Rng| random.random_range(-LARGEST..LARGEST);
        let count = self.levels.unwrap_or_default();
        let choice: Vec<f64> = match self.in_order {
            true => levels_in_order(count, random),
            false => (0..count).map(|_| level(random)).collect(),
        };
        let (mut input, mut output) = (Vec::new(), Vec::new());
        let (mut angle, mut before) = (0.0, 0.0);
        for hold in 0..HOLDS {
            let command = match choice.len() {
                0 => level(random),
                count if self.in_order => choice[hold % count],
                count => choice[random.random_range(0..count)],
            };
            let wait = self.frame * random.random_range(0.0..1.0);
            let from = angle;
            let held = if self.in_order { 30..50u32 } else { 60..100 };
            for row in 0..random.random_range(held) {
                let time = f64::from(row) * PERIOD;
                angle = match time < wait {
                    true => towards(before, from, time),
                    false => towards(command, towards(before, from, wait), time - wait),
                };
                input.push(self.as_written(command));
                output.push(angle + self.noise * normal(random));
            }
            before = command;
        }
        Record::of_run(PERIOD, input, output).expect("a simulated record is sound")
    }

    fn as_written(&self, command: f64) -> f64 {
        match self.written > 0.0 {
            true => (command / self.written).round() * self.written,
            false => command,
        }
    }
}

/// Levels that are written as different numbers: one in the middle of each of so many equal parts of the range, in any order.
fn levels_in_order(count: usize, random: &mut ChaCha8Rng) -> Vec<f64> {
    let width = 2.0 * LARGEST / count as f64;
    let parts = (0..count).map(|part| part as f64);
    let mut levels: Vec<f64> = parts
        .map(|part| width * (part + random.random_range(0.25..0.75)) - LARGEST)
        .collect();
    levels.shuffle(random);
    levels
}

/// The step response of the servo, `time` after the step \[s\].
fn answer(time: f64) -> f64 {
    1.0 - (-time.max(0.0) / LAG).exp()
}

/// The angle `time` \[s\] after it was `from`, under a command that stays.
fn towards(command: f64, from: f64, time: f64) -> f64 {
    from + (command - from) * answer(time)
}

/// The lines of the documentation.
#[must_use]
pub fn scattering_holds() -> Vec<ScatteringHolds> {
    let none = ScatteringHolds::NONE;
    let waits = [0.0, 0.003, 0.01, 0.02].map(|frame| ScatteringHolds { frame, ..none });
    let rounded = [None, Some(20), Some(8), Some(6), Some(5)].map(|levels| {
        [0.1, 0.5].map(|written| ScatteringHolds {
            written,
            levels,
            ..none
        })
    });
    let in_order = [10, 6].map(|levels| {
        [0.1, 0.5].map(|written| ScatteringHolds {
            written,
            levels: Some(levels),
            in_order: true,
            ..none
        })
    });
    let both = ScatteringHolds {
        frame: 0.02,
        written: 0.2,
        ..none
    };
    let in_noise = |line: ScatteringHolds| ScatteringHolds { noise: 0.1, ..line };
    let quiet = [
        &waits[..],
        rounded.as_flattened(),
        in_order.as_flattened(),
        &[both],
    ]
    .concat();
    let loud = [waits[3], rounded[0][1], rounded[2][1]].map(in_noise);
    [&quiet[..], &loud].concat()
}
