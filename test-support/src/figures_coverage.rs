//! How often the claims of a model of a linear servo are true, under references and sensors that carry little
//! information: smooth ones, a few sines, and a converter whose steps are larger than the noise.

use std::collections::BTreeMap;
use std::f64::consts::TAU;

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use servoid_identification::results::{Interval, Model};
use servoid_identification::{Options, Record, identify};

use crate::servos::{Linear, PERIOD, measured, staircase, stairs};

/// The input of the servo.
#[derive(Debug, Clone, PartialEq)]
pub enum Reference {
    /// Of the paper.
    Staircase,
    /// The staircase behind this many lags of 20 Hz.
    Smooth(usize),
    /// Sines of these amplitudes and frequencies \[Hz\].
    Sines(Vec<(f64, f64)>),
    /// Random holds of one to 10 frames of 20 ms at 5 degrees to either side.
    RandomSteps,
    /// Many levels, each held for half a second.
    Stairs,
}

impl Reference {
    /// The command \[degrees\], and where it had stood before.
    fn input(&self) -> (Vec<f64>, f64) {
        match self {
            Self::Staircase => (staircase(), -5.0),
            Self::Smooth(lags) => {
                let keep = (-TAU * 20.0 * PERIOD).exp();
                let lag = |input: Vec<f64>| -> Vec<f64> {
                    let follow = |state: &mut f64, u: &f64| {
                        *state = keep * *state + (1.0 - keep) * u;
                        Some(*state)
                    };
                    input.iter().scan(-5.0, follow).collect()
                };
                ((0..*lags).fold(staircase(), |input, _| lag(input)), -5.0)
            }
            Self::Sines(sines) => {
                let at = |k: usize| -> f64 {
                    let t = k as f64 * PERIOD;
                    sines.iter().map(|(a, hz)| a * (TAU * hz * t).sin()).sum()
                };
                ((0..3600).map(at).collect(), 0.0)
            }
            Self::RandomSteps => {
                let mut random = ChaCha8Rng::seed_from_u64(40);
                let mut input = Vec::new();
                while input.len() < 3600 {
                    let hold = 10 * random.random_range(1..=10);
                    let level = if random.random::<bool>() { 5.0 } else { -5.0 };
                    input.extend(std::iter::repeat_n(level, hold));
                }
                (input, 0.0)
            }
            Self::Stairs => (stairs(&[-5.0, -3.0, -1.0, 1.0, 3.0, 5.0], 2, 250), -5.0),
        }
    }
}

/// The noise of the sensor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Sensor {
    /// The rig's noise times this, and its converter.
    Noisy(f64),
    /// White noise of this standard deviation, without a converter.
    White(f64),
    /// The converter alone; each run has another offset, a fraction of its step.
    Rounding,
}

/// One line of the table.
#[derive(Debug, Clone)]
pub struct Case {
    pub servo: (&'static str, Linear),
    pub reference: Reference,
    pub sensor: Sensor,
}

/// The claims of a model, in the order of the table.
pub const NAMES: [&str; 8] = [
    "gain",
    "t5",
    "t50",
    "rise",
    "overshoot",
    "bandwidth",
    "step",
    "frequency",
];

/// Of the runs of one case.
#[derive(Debug, Clone)]
pub struct Line {
    /// Share of all runs whose bounds have a level.
    pub level: f64,
    /// Of the runs with a level: shares in which each claim is true; of the frequency response, of its points.
    pub held: [f64; NAMES.len()],
    /// Of all runs: shares in which a figure has a value, with a level or without.
    pub stated: [f64; 6],
    /// Mean half width of the step band, each point.
    pub half_width: f64,
    /// Shares of runs with each piece of advice.
    pub advice: BTreeMap<String, f64>,
}

struct Truth {
    figures: [f64; 6],
    servo: Linear,
    /// Of the held and sampled servo.
    impulse: Vec<f64>,
}

struct Outcome {
    level: bool,
    held: [bool; NAMES.len() - 1],
    /// Share of the frequencies whose bounds hold.
    frequencies_held: f64,
    stated: [bool; 6],
    model: Model,
}

/// Identifies `runs` records with seeds from `seed` on.
pub fn measure(case: &Case, runs: u64, seed: u64) -> Line {
    let servo = &case.servo.1;
    let (input, rest) = case.reference.input();
    let clean = servo.respond(&input, rest, 0.0);
    let figures = servo.figures();
    let truth = Truth {
        figures: [
            servo.gain,
            figures.delay_s,
            figures.t50_s,
            figures.rise_s,
            figures.overshoot_percent,
            figures.bandwidth_rad_s,
        ],
        servo: servo.clone(),
        impulse: (0..1500)
            .map(|i| servo.step(f64::from(i) * PERIOD) - servo.step(f64::from(i - 1) * PERIOD))
            .collect(),
    };
    let outcomes: Vec<Outcome> = (seed..seed + runs)
        .into_par_iter()
        .map(|seed| outcome(&truth, &input, &output(&clean, case.sensor, seed)))
        .collect();
    let share = |count: usize, of: usize| count as f64 / of.max(1) as f64;
    let levels = outcomes.iter().filter(|o| o.level).count();
    let mut advice = BTreeMap::new();
    for found in outcomes.iter().flat_map(|o| &o.model.advice) {
        *advice.entry(found.check.to_string()).or_insert(0.0) += 1.0 / runs as f64;
    }
    Line {
        level: share(levels, outcomes.len()),
        held: std::array::from_fn(|i| {
            let with_level = outcomes.iter().filter(|o| o.level);
            let held = |o: &Outcome| match o.held.get(i) {
                Some(held) => f64::from(u8::from(*held)),
                None => o.frequencies_held,
            };
            with_level.map(held).sum::<f64>() / levels.max(1) as f64
        }),
        stated: std::array::from_fn(|i| {
            share(
                outcomes.iter().filter(|o| o.stated[i]).count(),
                outcomes.len(),
            )
        }),
        half_width: outcomes
            .iter()
            .filter_map(|o| o.model.step.bounds.valid())
            .map(|bounds| bounds.mean_half_widths().0)
            .sum::<f64>()
            / levels.max(1) as f64,
        advice,
    }
}

fn output(clean: &[f64], sensor: Sensor, seed: u64) -> Vec<f64> {
    match sensor {
        Sensor::Noisy(scale) => measured(clean, scale, seed),
        Sensor::White(sd) => {
            let mut random = ChaCha8Rng::seed_from_u64(seed);
            let mut noise = || {
                sd * rand_distr::Distribution::<f64>::sample(
                    &rand_distr::StandardNormal,
                    &mut random,
                )
            };
            clean.iter().map(|y| y + noise()).collect()
        }
        Sensor::Rounding => {
            // More than one step of the converter.
            let offset: f64 = ChaCha8Rng::seed_from_u64(seed).random_range(-0.1..0.1);
            let moved: Vec<f64> = clean.iter().map(|y| y + offset).collect();
            measured(&moved, 0.0, seed)
        }
    }
}

fn outcome(truth: &Truth, input: &[f64], output: &[f64]) -> Outcome {
    let record = Record::of_run(PERIOD, input, output).unwrap();
    let model = identify(&record, &Options::default()).unwrap();
    let m = &model.metrics;
    let intervals: [Interval; 6] = [
        m.dc_gain,
        m.delay_s,
        m.t50_s,
        m.rise_time_s,
        m.overshoot_percent,
        m.bandwidth_rad_s,
    ];
    let mut held = [false; NAMES.len() - 1];
    for (i, (interval, exact)) in intervals.iter().zip(truth.figures).enumerate() {
        held[i] = interval.contains(exact);
    }
    held[6] = step_held(&model, &truth.servo);
    Outcome {
        level: model.bounds.valid().is_some(),
        held,
        frequencies_held: frequencies_held(&model, &truth.impulse),
        stated: intervals.map(|interval| interval.value.is_some()),
        model,
    }
}

/// Whether the whole step response is inside its simultaneous band.
fn step_held(model: &Model, servo: &Linear) -> bool {
    let Some(bounds) = model.step.bounds.valid() else {
        return false;
    };
    let band = &bounds.simultaneous;
    let last = band.lower.len() - 1;
    (0..=last).all(|m| {
        let exact = match m {
            m if m == last => servo.gain,
            m => servo.step(m as f64 * PERIOD),
        };
        (band.lower[m]..=band.upper[m]).contains(&exact)
    })
}

/// The share of the frequencies at which magnitude and phase are both inside their bounds.
fn frequencies_held(model: &Model, impulse: &[f64]) -> f64 {
    let f = &model.frequency;
    let Some(bounds) = f.bounds.valid() else {
        return 0.0;
    };
    let points = f.omega_rad_s.len();
    let held = (0..points).filter(|&k| {
        let (magnitude_db, phase_deg) = transformed(impulse, f.omega_rad_s[k] * PERIOD);
        let phase_deg = phase_deg - 360.0 * ((phase_deg - f.phase_deg[k]) / 360.0).round();
        (bounds.magnitude_db_lower[k]..=bounds.magnitude_db_upper[k]).contains(&magnitude_db)
            && (bounds.phase_deg_lower[k]..=bounds.phase_deg_upper[k]).contains(&phase_deg)
    });
    held.count() as f64 / points as f64
}

/// Magnitude \[dB\] and phase \[degrees\] at a frequency \[rad/sample\].
fn transformed(impulse: &[f64], omega: f64) -> (f64, f64) {
    let (mut re, mut im) = (0.0, 0.0);
    for (h, i) in impulse.iter().zip(0..) {
        let (sin, cos) = (omega * f64::from(i)).sin_cos();
        re += h * cos;
        im -= h * sin;
    }
    (20.0 * re.hypot(im).log10(), im.atan2(re).to_degrees())
}
