//! Two servos whose runs scatter in gain, delay and natural frequency, compared by several runs a side.
//!
//! What the comparison says of the servos is held against the formulas of their means.

use crate::plants::{normal, random};
use crate::servos::{Linear, PERIOD, measured, staircase};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use servoid_identification::comparison::{
    Comparison, ComparisonOptions, DifferenceCurve, Verdict, compare,
};
use servoid_identification::results::Bounds;
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
    /// Of the natural frequency, as a share of it.
    pub frequency_sd: f64,
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
    /// Pairs with bounds in which each curve of the difference is everywhere within its bounds.
    pub curves_held: usize,
    /// Pairs whose interval of the delay shift does, and pairs that have one.
    pub shift_held: (usize, usize),
    /// Mean of `at_most` \[%\].
    pub at_most_percent: f64,
}

/// With another natural frequency by this factor.
fn servo(gain: f64, delay_s: f64, faster: f64) -> Linear {
    Linear::second_order(gain, delay_s, 0.5, 60.0 * faster)
}

impl Means {
    /// Gain and delay of both.
    fn gains_and_delays(&self) -> [(f64, f64); 2] {
        let (gain, delay_s) = (0.97, 0.0255);
        [
            (gain, delay_s),
            (gain * self.second_gain, delay_s + self.later_s),
        ]
    }

    fn servos(&self) -> [Linear; 2] {
        self.gains_and_delays()
            .map(|(gain, delay_s)| servo(gain, delay_s, 1.0))
    }

    fn record(&self, (gain, delay_s): (f64, f64), random: &mut ChaCha8Rng) -> Record<'static> {
        let input = staircase();
        let run = |_| {
            let gain = gain * (1.0 + self.gain_sd * normal(random));
            let delay_s = delay_s + self.delay_sd_s * normal(random);
            // None is drawn where none scatters, so that seeds stay what they were.
            let faster = match self.frequency_sd > 0.0 {
                true => 1.0 + self.frequency_sd * normal(random),
                false => 1.0,
            };
            let servo = servo(gain, delay_s, faster);
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

    /// Whether each curve is everywhere within its bounds.
    fn holds_curves(&self, found: &Comparison) -> bool {
        let [first, second] = self.servos();
        let holds = |curve: &DifferenceCurve| {
            let truth = |t: f64| 100.0 * (second.step(t) - first.step(t)) / first.gain;
            let Bounds::Valid(bounds) = &curve.bounds else {
                return false;
            };
            let ends = bounds.lower.iter().zip(&bounds.upper);
            let mut points = curve.time_s.iter().zip(ends);
            points.all(|(t, (lower, upper))| (*lower..=*upper).contains(&truth(*t)))
        };
        found.curves.iter().all(holds)
    }

    /// Compares as many pairs; pair k has the seed k.
    pub fn compare(&self, pairs: u64) -> Outcome {
        let one = |seed: u64| {
            let mut random = random(seed);
            let both = self.gains_and_delays();
            let [a, b] = both.map(|servo| self.record(servo, &mut random));
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
            curves_held: found
                .iter()
                .filter(|c| c.bounds.valid().is_some() && self.holds_curves(c))
                .count(),
            shift_held: (shift_held.count(), shifts.len()),
            at_most_percent: most / bounds().count() as f64,
        }
    }
}
