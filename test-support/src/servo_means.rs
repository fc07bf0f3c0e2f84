//! Two servos whose runs scatter in gain and delay, compared by several runs a side.
//!
//! What the comparison says of the servos is held against the formulas of their means.

use crate::plants::{normal, random};
use crate::servos::{Linear, PERIOD, measured, staircase};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use servoid_identification::comparison::{Comparison, ComparisonOptions, Verdict, compare};
use servoid_identification::{Record, Run};

/// What is compared.
#[derive(Debug, Clone, Copy)]
pub struct Means {
    /// Runs on each side.
    pub runs: usize,
    /// Standard deviation of the gain from run to run, as a share of it.
    pub gain_sd: f64,
    /// Of the delay \[s\].
    pub delay_sd_s: f64,
    /// Gain of the second servo relative to that of the first.
    pub second_gain: f64,
    /// How much later the second servo answers \[s\].
    pub later_s: f64,
}

/// What came out of many pairs.
#[derive(Debug, Clone, Copy, Default)]
pub struct Outcome {
    pub different: usize,
    pub undecided: usize,
    pub same: usize,
    /// Pairs whose `at_least` .. `at_most` holds the truth.
    pub held: usize,
    /// Pairs whose interval of the delay shift does, and pairs that have one.
    pub shift_held: (usize, usize),
    /// Mean of `at_most` \[%\].
    pub at_most_percent: f64,
}

impl Means {
    fn servos(&self) -> [Linear; 2] {
        let first = Linear::second_order(0.97, 0.0255, 0.5, 60.0);
        let mut second = first.clone();
        second.gain *= self.second_gain;
        second.delay_s += self.later_s;
        [first, second]
    }

    fn record(&self, servo: &Linear, random: &mut ChaCha8Rng) -> Record<'static> {
        let input = staircase();
        let run = |_| {
            let mut servo = servo.clone();
            servo.gain *= 1.0 + self.gain_sd * normal(random);
            servo.delay_s += self.delay_sd_s * normal(random);
            let clean = servo.respond(&input, -5.0, 0.0);
            let seed = rand::Rng::next_u64(random);
            Run::new(input.clone(), measured(&clean, 1.0, seed)).expect("one length")
        };
        let runs: Vec<Run> = (0..self.runs).map(run).collect();
        Record::new(PERIOD, runs).expect("it moves")
    }

    /// Largest difference of the mean responses \[% of the step of the first\].
    fn truth_percent(&self) -> f64 {
        let [first, second] = self.servos();
        let apart = |m: usize| {
            let t = m as f64 * PERIOD;
            (second.step(t) - first.step(t)).abs()
        };
        100.0 * (0..400).map(apart).fold(0.0, f64::max) / first.gain
    }

    /// Compares as many pairs; pair k has the seed k.
    pub fn compare(&self, pairs: u64) -> Outcome {
        let one = |seed: u64| {
            let mut random = random(seed);
            let [a, b] = self.servos().map(|servo| self.record(&servo, &mut random));
            compare(&a, &b, &ComparisonOptions::default()).expect("well excited")
        };
        let found: Vec<Comparison> = (0..pairs).into_par_iter().map(one).collect();
        let count = |verdict| found.iter().filter(|c| c.verdict == verdict).count();
        let bounds = || found.iter().filter_map(|c| c.bounds.valid());
        let truth = self.truth_percent();
        let holds = bounds().filter(|bounds| {
            let known = bounds.difference_percent;
            (known.at_least..=known.at_most).contains(&truth)
        });
        let shifts: Vec<[f64; 2]> = bounds().filter_map(|b| b.delay_shift_s).collect();
        let shift_held = shifts
            .iter()
            .filter(|[low, high]| (*low..=*high).contains(&self.later_s));
        let most: f64 = bounds().map(|b| b.difference_percent.at_most).sum();
        Outcome {
            different: count(Verdict::Different),
            undecided: count(Verdict::Undecided),
            same: count(Verdict::Same),
            held: holds.count(),
            shift_held: (shift_held.count(), shifts.len()),
            at_most_percent: most / bounds().count() as f64,
        }
    }
}
