//! How often the intervals of the metrics hold the exact figures.

use rayon::prelude::*;
use servoid_identification::results::{Interval, Metrics};
use servoid_identification::{Options, Record, Settling, identify};

use crate::servos::{Figures, Linear, PERIOD, measured, staircase};

/// The figures of the table, in its order.
pub const NAMES: [&str; 8] = [
    "gain",
    "t5",
    "t50",
    "rise",
    "overshoot",
    "settling",
    "bandwidth",
    "-90 deg",
];

/// A servo, how its samples are taken, and how it is identified.
#[derive(Debug, Clone)]
pub struct Case {
    pub servo: Linear,
    pub sample_phase_s: f64,
    /// Factor on the noise.
    pub noise: f64,
    pub settling: Settling,
    pub level: f64,
}

/// Of one figure.
#[derive(Debug, Clone, Copy, Default)]
pub struct Coverage {
    /// Share of runs whose interval holds the exact figure.
    pub share: f64,
    /// Mean width, of the intervals with both ends.
    pub width: f64,
    /// Share of runs with both ends.
    pub closed: f64,
    pub exact: f64,
    /// Mean error of the estimate.
    pub bias: f64,
}

/// Identifies `runs` records that differ in their noise, seeds `seed`, `seed` + 1, ...
pub fn run(case: &Case, runs: u64, seed: u64) -> [Coverage; 8] {
    let input = staircase();
    let clean = case.servo.respond(&input, -5.0, case.sample_phase_s);
    let exact = exact_in_order(case.servo.gain, &case.servo.figures());
    let found: Vec<[Interval; 8]> = (0..runs)
        .into_par_iter()
        .map(|k| {
            let output = measured(&clean, case.noise, seed + k);
            let record = Record::of_run(PERIOD, &input, &output)
                .unwrap()
                .with_sample_phase(case.sample_phase_s);
            let options = Options {
                settling: case.settling,
                level: case.level,
                ..Options::default()
            };
            in_order(&identify(&record, &options).unwrap().metrics)
        })
        .collect();
    std::array::from_fn(|i| {
        let mean = |of: &dyn Fn(&Interval) -> f64| {
            found.iter().map(|intervals| of(&intervals[i])).sum::<f64>() / runs as f64
        };
        let both = |interval: &Interval| interval.lower.zip(interval.upper);
        let closed = mean(&|interval| f64::from(u8::from(both(interval).is_some())));
        Coverage {
            share: mean(&|interval| f64::from(u8::from(interval.contains(exact[i])))),
            width: mean(&|interval| both(interval).map_or(0.0, |(low, high)| high - low)) / closed,
            closed,
            exact: exact[i],
            bias: mean(&|interval| interval.value.map_or(0.0, |value| value - exact[i])),
        }
    })
}

/// The exact figures, as [`NAMES`] has them.
pub(crate) fn exact_in_order(gain: f64, figures: &Figures) -> [f64; 8] {
    [
        gain,
        figures.delay_s,
        figures.t50_s,
        figures.rise_s,
        figures.overshoot_percent,
        figures.settling_s,
        figures.bandwidth_rad_s,
        figures.phase_minus_90_rad_s,
    ]
}

/// The metrics as [`NAMES`] has them.
pub(crate) fn in_order(metrics: &Metrics) -> [Interval; 8] {
    [
        metrics.dc_gain,
        metrics.delay_s,
        metrics.t50_s,
        metrics.rise_time_s,
        metrics.overshoot_percent,
        metrics.settling_time_s,
        metrics.bandwidth_rad_s,
        metrics.phase_minus_90_rad_s,
    ]
}
