//! Pairs of recordings that differ by a shift in time alone, and of servos that differ otherwise: which of them a comparison says to differ by a shift alone.

use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use servoid_identification::Record;
use servoid_identification::comparison::{Comparison, ComparisonOptions, compare};

use crate::plants::{normal, random};
use crate::servos::Linear;

/// Size of the commands \[degrees\].
const SIZE: f64 = 10.0;

/// Time that a servo remembers \[s\]: 25 of the longest of its time constants here.
const MEMORY_S: f64 = 2.0;

/// What the second servo is beside the first.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Second {
    /// Later by this time \[s\]; earlier, where that is negative, and alike where it is zero.
    Later(f64),
    /// Of a bandwidth that is this many times that of the first.
    Quicker(f64),
    /// Of a damping ratio that is this many times that of the first.
    Damped(f64),
    /// With a further lag of this time constant \[s\].
    Lagging(f64),
    /// Of this gain.
    Gain(f64),
}

impl Second {
    /// Whether a shift in time is all that the two differ by.
    #[must_use]
    pub fn is_shift(self) -> bool {
        matches!(self, Self::Later(by) if by != 0.0)
    }
}

/// What a comparison said of many pairs, as counts.
#[derive(Debug, Clone, Copy, Default)]
pub struct Said {
    pub pairs: usize,
    /// Pairs with bounds.
    pub claimed: usize,
    /// Pairs that are said to differ by a shift alone.
    pub shift_alone: usize,
    /// Pairs that are said to differ by more than a shift.
    pub more: usize,
    /// Intervals of the shift of pairs whose second servo is later, or earlier, or alike; and how many of them hold.
    pub intervals: usize,
    pub held: usize,
}

/// Commands: levels that are held, or a stick.
fn command(random: &mut ChaCha8Rng, rows: usize, period_s: f64) -> Vec<f64> {
    let kind = random.random_range(0..5);
    let hold = match kind {
        0 => random.random_range(0.3..1.0),
        _ => random.random_range(0.08..0.3),
    };
    let hold = ((hold / period_s) as usize).max(2);
    let levels: Vec<f64> = (0..rows.div_ceil(hold))
        .map(|_| match kind {
            0 => SIZE * (f64::from(random.random_range(0..6_u32)) / 2.5 - 1.0),
            1 => [-SIZE, SIZE][random.random_range(0..2)],
            _ => random.random_range(-SIZE..SIZE),
        })
        .collect();
    let held: Vec<f64> = (0..rows).map(|k| levels[k / hold]).collect();
    match kind {
        3 => by_hand(held, 0.05, period_s),
        4 => {
            let noise = (0..rows).map(|_| normal(random)).collect();
            let moved = by_hand(noise, random.random_range(0.05..0.2), period_s);
            let largest = moved.iter().fold(0.0, |most: f64, u| most.max(u.abs()));
            moved.into_iter().map(|u| SIZE / largest * u).collect()
        }
        _ => held,
    }
}

/// Behind two lags.
fn by_hand(wanted: Vec<f64>, lag_s: f64, period_s: f64) -> Vec<f64> {
    let keep = (-period_s / lag_s).exp();
    let mut lags = [0.0; 2];
    let follow = |u: f64| {
        lags[0] += (1.0 - keep) * (u - lags[0]);
        lags[1] += (1.0 - keep) * (lags[0] - lags[1]);
        lags[1]
    };
    wanted.into_iter().map(follow).collect()
}

/// The answer to commands each held for a row, from rest at zero.
fn respond(servo: &Linear, input: &[f64], period_s: f64) -> Vec<f64> {
    let memory = (MEMORY_S / period_s) as usize;
    let at = |k: usize| servo.step(k as f64 * period_s);
    let impulse: Vec<f64> = (0..memory).map(|k| at(k + 1) - at(k)).collect();
    let answer = |k: usize| {
        let before = input[..k].iter().rev().zip(&impulse);
        before.map(|(u, g)| u * g).sum()
    };
    (0..input.len()).map(answer).collect()
}

impl Second {
    fn beside(self, random: &mut ChaCha8Rng) -> [Linear; 2] {
        let delay_s = random.random_range(0.022..0.035);
        let (omega, zeta) = (
            random.random_range(30.0..80.0),
            random.random_range(0.5..0.95),
        );
        let lag_s = random
            .random_bool(0.5)
            .then(|| random.random_range(0.005..0.03));
        let servo = |gain: f64, delay_s: f64, zeta: f64, omega: f64| {
            let servo = Linear::second_order(gain, delay_s, zeta, omega);
            match lag_s {
                Some(lag_s) => servo.with_lag(lag_s),
                None => servo,
            }
        };
        let first = servo(1.0, delay_s, zeta, omega);
        let second = match self {
            Self::Later(by) => servo(1.0, delay_s + by, zeta, omega),
            Self::Quicker(times) => servo(1.0, delay_s, zeta, times * omega),
            Self::Damped(times) => servo(1.0, delay_s, times * zeta, omega),
            Self::Lagging(lag_s) => servo(1.0, delay_s, zeta, omega).with_lag(lag_s),
            Self::Gain(gain) => servo(gain, delay_s, zeta, omega),
        };
        [first, second]
    }

    /// The comparison of a pair of recordings, in a third of all with commands of their own.
    #[must_use]
    pub fn compare(self, seed: u64) -> Comparison {
        let mut random = random(seed);
        let servos = self.beside(&mut random);
        let period_s = [0.002, 0.004, 0.005, 0.01, 0.02][random.random_range(0..5)];
        let rows = (random.random_range(10.0..40.0) / period_s) as usize;
        let sd = SIZE * [0.0005, 0.002, 0.005, 0.01, 0.02][random.random_range(0..5)];
        let common = command(&mut random, rows, period_s);
        let of_its_own = random.random_range(0..3) == 0;
        let other = match of_its_own {
            true => command(&mut random, rows, period_s),
            false => common.clone(),
        };
        let mut record = |servo: &Linear, input: &[f64]| {
            let clean = respond(servo, input, period_s).into_iter();
            let output: Vec<f64> = clean.map(|y| y + sd * normal(&mut random)).collect();
            Record::of_run(period_s, input.to_vec(), output).expect("a simulated record is sound")
        };
        let (a, b) = (record(&servos[0], &common), record(&servos[1], &other));
        compare(&a, &b, &ComparisonOptions::default()).expect("long enough for a response")
    }

    /// Whether the intervals of the shift hold it, where it is one number whatever it is counted by.
    fn held(self, found: &Comparison) -> Vec<bool> {
        let Self::Later(by) = self else {
            return Vec::new();
        };
        let intervals = found.curves.iter().map(|curve| curve.delay_shift_s);
        let known = intervals.filter(|shift| shift.lower.is_some());
        known.map(|shift| shift.contains(by)).collect()
    }

    /// What is said of as many pairs, of seeds from `first` on.
    #[must_use]
    pub fn said(self, pairs: u64, first: u64) -> Said {
        let one = |seed| {
            let found = self.compare(seed);
            let held = self.held(&found);
            Said {
                pairs: 1,
                claimed: usize::from(found.bounds.valid().is_some()),
                shift_alone: usize::from(found.summary.contains("Apart from that shift in time")),
                more: usize::from(found.summary.contains("That is not all")),
                intervals: held.len(),
                held: held.iter().filter(|held| **held).count(),
            }
        };
        let add = |all: Said, one: Said| Said {
            pairs: all.pairs + one.pairs,
            claimed: all.claimed + one.claimed,
            shift_alone: all.shift_alone + one.shift_alone,
            more: all.more + one.more,
            intervals: all.intervals + one.intervals,
            held: all.held + one.held,
        };
        let said = (first..first + pairs).into_par_iter().map(one);
        said.reduce(Said::default, add)
    }
}
