//! Recordings of sweeps and sums of sines, which determine a servo's response in a band alone.

use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use servoid_identification::flight_model::{self, FlightModel, FlightModelOptions};
use servoid_identification::results::Model;
use servoid_identification::{Options, Record, identify};
use std::f64::consts::TAU;

use crate::low_order_coverage::{Exact, OfLowOrder};
use crate::plants::{normal, random};
use crate::servos::{Limit, Linear, limited_in_steps};

/// Length of a recording \[s\].
const DURATION: f64 = 60.0;

/// Lowest and highest frequency of an input \[Hz\].
const FROM: f64 = 0.2;
const TO: f64 = 20.0;

/// Time that a sum of sines has lasted before its recording \[s\]: two of its periods.
const BEFORE: f64 = 10.0;

/// Time that a servo remembers \[s\]: 15 time constants of the slow end.
const MEMORY: f64 = 6.0;

/// Time constant of the slow end \[s\].
const SLOW: f64 = 0.4;

/// What is commanded, within ±10 degrees or about them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Input {
    /// Faster by equal factors in equal times.
    LogarithmicSweep,
    /// Faster by equal frequencies in equal times.
    LinearSweep,
    /// A line of one degree at each multiple of the lowest frequency, with random phases that are the same for every seed.
    SumOfSines,
}

impl Input {
    fn samples(self, period_s: f64) -> Vec<f64> {
        let count = (DURATION / period_s).round() as usize;
        let times = (0..count).map(|k| k as f64 * period_s);
        match self {
            Self::LogarithmicSweep => {
                let rate = (TO / FROM).ln() / DURATION;
                let cycles = |t: f64| FROM / rate * ((rate * t).exp() - 1.0);
                times.map(|t| 10.0 * (TAU * cycles(t)).sin()).collect()
            }
            Self::LinearSweep => {
                let rate = (TO - FROM) / DURATION;
                let cycles = |t: f64| FROM * t + rate * t * t / 2.0;
                times.map(|t| 10.0 * (TAU * cycles(t)).sin()).collect()
            }
            Self::SumOfSines => {
                let mut random = random(99);
                let lines: Vec<(f64, f64)> = (1..=(TO / FROM).round() as u32)
                    .map(|line| (TAU * FROM * f64::from(line), random.random_range(0.0..TAU)))
                    .collect();
                let before = (BEFORE / period_s).round() as usize;
                let at = |t: f64| -> f64 { lines.iter().map(|(w, p)| (w * t + p).cos()).sum() };
                let all = (0..count + before).map(|k| at(k as f64 * period_s));
                all.collect()
            }
        }
    }

    /// Samples of the input that precede the recording.
    fn before(self, period_s: f64) -> usize {
        match self {
            Self::SumOfSines => (BEFORE / period_s).round() as usize,
            Self::LogarithmicSweep | Self::LinearSweep => 0,
        }
    }
}

/// Who follows it.
#[derive(Debug, Clone)]
pub enum Servo {
    /// A linear servo, with this share of its response as a lag of 0.4 s.
    Linear(Linear, f64),
    /// One that is not, as [`limited_in_steps`] has it.
    Limited(Limit),
}

impl Servo {
    /// Its answer to an impulse of one sample, where it is linear.
    fn impulse(&self, period_s: f64) -> Option<Vec<f64>> {
        let Self::Linear(servo, share) = self else {
            return None;
        };
        let slow = Linear::first_order(servo.gain, servo.delay_s, SLOW);
        let step = |t: f64| (1.0 - share) * servo.step(t) + share * slow.step(t);
        let at = |k: usize| step(k as f64 * period_s);
        let count = (MEMORY / period_s).round() as usize;
        let further = (1..count).map(|k| at(k) - at(k - 1));
        Some(std::iter::once(at(0)).chain(further).collect())
    }

    /// The lowest frequency at which the servo itself, without the hold of its samples, is a quarter turn late, to a thousandth \[rad/s\].
    fn minus_90(&self) -> Option<f64> {
        let Self::Linear(servo, share) = self else {
            return None;
        };
        let slow = Linear::first_order(servo.gain, servo.delay_s, SLOW);
        let response = |w: f64| servo.response(w) * (1.0 - share) + slow.response(w) * *share;
        let late = |step: &u32| response(f64::from(*step) * 1e-3).re < 0.0;
        (1..).find(late).map(|step| f64::from(step) * 1e-3)
    }

    fn respond(&self, input: &[f64], period_s: f64) -> Vec<f64> {
        if let Self::Limited(limit) = self {
            return limited(input, period_s, *limit);
        }
        let h = self.impulse(period_s).unwrap_or_default();
        let at = |k: usize| {
            h.iter()
                .zip(input[..=k].iter().rev())
                .map(|(h, u)| h * u)
                .sum()
        };
        (0..input.len()).into_par_iter().map(at).collect()
    }
}

/// Second order, 50 rad/s and damping .7, 12 ms late, with a limit; in ten steps of Euler's rule for each sample.
fn limited(input: &[f64], period_s: f64, limit: Limit) -> Vec<f64> {
    let dt = period_s / 10.0;
    let late = (0.012 / dt).round() as usize;
    limited_in_steps(0.7, 50.0, limit, input, input[0], (dt, 10, late))
}

/// Noise of the sensor with a standard deviation \[deg\].
#[derive(Debug, Clone, Copy)]
pub enum Noise {
    White(f64),
    /// Keeps .9 of its last value.
    Ar1(f64),
    /// 1/(1 - 1.6 z^-1 + .8 z^-2).
    Ar2(f64),
}

impl Noise {
    fn samples(self, random: &mut ChaCha8Rng, count: usize) -> Vec<f64> {
        let (one, two, spread): (f64, f64, f64) = match self {
            Self::White(spread) => (0.0, 0.0, spread),
            Self::Ar1(spread) => (0.9, 0.0, spread),
            Self::Ar2(spread) => (1.6, -0.8, spread),
        };
        // The variance of what drives it over its own, by Yule and Walker.
        let share: f64 = (1.0 + two) * ((1.0 - two).powi(2) - one * one) / (1.0 - two);
        let drive = spread * share.sqrt();
        let warm_up = 500;
        let (mut last, mut before) = (0.0, 0.0);
        let mut next = || {
            let value = one * last + two * before + drive * normal(random);
            (last, before) = (value, last);
            value
        };
        let all: Vec<f64> = (0..count + warm_up).map(|_| next()).collect();
        all[warm_up..].to_vec()
    }
}

/// A line of the table.
#[derive(Debug, Clone)]
pub struct SmoothInput {
    /// Its first column.
    pub label: &'static str,
    pub input: Input,
    pub servo: Servo,
    pub noise: Noise,
    /// Time between rows \[s\].
    pub period_s: f64,
    /// Commands are written in steps of this \[deg\]; the servo gets finer ones. Zero: as they are.
    pub written: f64,
}

/// How often bounds in the band hold.
#[derive(Debug, Clone, Default)]
pub struct InBand {
    /// Recordings with bounds in a band.
    pub claimed: usize,
    pub runs: usize,
    /// Means of the ends of the band \[Hz\].
    pub band_hz: [f64; 2],
    /// Share of the recordings whose magnitude is within its bounds: the mean over the frequencies, and at the worst of them.
    pub magnitude: [f64; 2],
    /// The same of the phase.
    pub phase: [f64; 2],
    /// Half width of the bounds of the magnitude in the mean of the recordings, at the median frequency \[dB\].
    pub half_width_db: f64,
    /// Of the intervals of the frequency of -90 degrees, those that hold the exact one.
    pub minus_90_held: usize,
    pub minus_90: usize,
    pub low_order: OfLowOrder,
}

/// What one frequency of one recording shows: magnitude and phase held, half width \[dB\].
type Point = (bool, bool, f64);

impl SmoothInput {
    /// The recordings of `runs` seeds from `first` on.
    #[must_use]
    pub fn measure(&self, runs: usize, first: u64) -> InBand {
        let (models, low_order): (Vec<Model>, Vec<Option<FlightModel>>) =
            self.identified(runs, first).into_iter().unzip();
        let mut found = InBand {
            claimed: models.len(),
            runs,
            ..InBand::default()
        };
        if let Some(impulse) = self.servo.impulse(self.period_s) {
            found.judge(&models, &impulse, self.period_s);
        }
        if let Some(exact) = self.servo.minus_90() {
            found.judge_minus_90(&models, exact);
        }
        if let Servo::Linear(servo, share) = &self.servo {
            let low_order = low_order.iter().flatten();
            let exact =
                |model: &FlightModel| named(servo, *share == 0.0 && model.order == servo.order());
            found.low_order = OfLowOrder::of(low_order, exact);
        }
        found
    }

    /// Those of them that have bounds in a band, each with its low-order model.
    #[must_use]
    pub fn identified(&self, runs: usize, first: u64) -> Vec<(Model, Option<FlightModel>)> {
        let all = self.input.samples(self.period_s);
        let before = self.input.before(self.period_s);
        let clean = self.servo.respond(&all, self.period_s).split_off(before);
        (first..first + runs as u64)
            .into_par_iter()
            .map(|seed| self.models(&all[before..], &clean, seed))
            .filter(|(model, _)| model.level().valid().is_none() && model.band().is_some())
            .collect()
    }

    fn models(&self, input: &[f64], clean: &[f64], seed: u64) -> (Model, Option<FlightModel>) {
        let noise = self.noise.samples(&mut random(seed), clean.len());
        let output: Vec<f64> = clean.iter().zip(noise).map(|(y, e)| y + e).collect();
        let written = |u: &f64| match self.written > 0.0 {
            true => (u / self.written).round() * self.written,
            false => *u,
        };
        let input: Vec<f64> = input.iter().map(written).collect();
        let record = Record::of_run(self.period_s, input, output).expect("it is sound");
        let model = identify(&record, &Options::default()).expect("it can be identified");
        let low_order = flight_model::fit(&record, &model, &FlightModelOptions::default()).ok();
        (model, low_order)
    }
}

/// What a model names of a servo of first or second order: gain alone where the model is not of its order.
fn named(servo: &Linear, is_of_its_order: bool) -> Exact {
    let mut exact = [Some(servo.gain), None, None, None, None];
    if is_of_its_order {
        match servo.parameters()[..] {
            [_, delay, lag] => (exact[1], exact[4]) = (Some(delay), Some(lag)),
            [_, delay, omega, zeta] => exact[1..4].copy_from_slice(&[delay, omega, zeta].map(Some)),
            _ => (),
        }
    }
    exact
}

impl InBand {
    fn judge(&mut self, models: &[Model], impulse: &[f64], period_s: f64) {
        let judged: Vec<Vec<Point>> = models
            .par_iter()
            .map(|model| points(model, impulse, period_s))
            .collect();
        let Some(frequencies) = judged.first().map(Vec::len) else {
            return;
        };
        let share = |of: &dyn Fn(&Point) -> f64| -> Vec<f64> {
            let at = |k: usize| judged.iter().map(|points| of(&points[k])).sum::<f64>();
            let mean = |k: usize| at(k) / judged.len() as f64;
            (0..frequencies).map(mean).collect()
        };
        let mean_and_worst = |shares: Vec<f64>| {
            let mean = shares.iter().sum::<f64>() / shares.len() as f64;
            [mean, shares.into_iter().fold(1.0, f64::min)]
        };
        self.magnitude = mean_and_worst(share(&|point| f64::from(point.0)));
        self.phase = mean_and_worst(share(&|point| f64::from(point.1)));
        let mut widths = share(&|point| point.2);
        widths.sort_by(f64::total_cmp);
        self.half_width_db = widths[frequencies / 2];
        for model in models {
            let omegas = &model.frequency.omega_rad_s;
            for (end, omega) in [omegas[0], omegas[omegas.len() - 1]].iter().enumerate() {
                self.band_hz[end] += omega / TAU / models.len() as f64;
            }
        }
    }

    fn judge_minus_90(&mut self, models: &[Model], exact: f64) {
        for model in models {
            let found = model.metrics.phase_minus_90_rad_s;
            if let (Some(lower), Some(upper)) = (found.lower, found.upper) {
                self.minus_90 += 1;
                self.minus_90_held += usize::from((lower..=upper).contains(&exact));
            }
        }
    }
}

/// Magnitude \[dB\] and phase \[rad\] of the samples at `omega` \[rad/s\].
pub fn response(impulse: &[f64], omega: f64, period_s: f64) -> (f64, f64) {
    let [mut re, mut im] = [0.0, 0.0];
    for (i, h) in impulse.iter().enumerate() {
        let (sin, cos) = (omega * period_s * i as f64).sin_cos();
        re += h * cos;
        im -= h * sin;
    }
    (20.0 * re.hypot(im).log10(), im.atan2(re))
}

fn points(model: &Model, impulse: &[f64], period_s: f64) -> Vec<Point> {
    let bounds = model.band().expect("those without were left out");
    let omegas = model.frequency.omega_rad_s.iter().enumerate();
    let at = |(k, omega): (usize, &f64)| {
        let (magnitude, phase) = response(impulse, *omega, period_s);
        let (low, high) = (bounds.magnitude_db_lower[k], bounds.magnitude_db_upper[k]);
        let (early, late) = (bounds.phase_deg_lower[k], bounds.phase_deg_upper[k]);
        let middle = f64::midpoint(early, late);
        let turns = ((middle - phase.to_degrees()) / 360.0).round();
        let phase = phase.to_degrees() + 360.0 * turns;
        (
            (low..=high).contains(&magnitude),
            (early..=late).contains(&phase),
            (high - low) / 2.0,
        )
    };
    omegas.map(at).collect()
}

/// The lines of the documentation.
#[must_use]
pub fn smooth_inputs() -> Vec<SmoothInput> {
    let a = || Linear::second_order(1.0, 0.012, 0.7, 50.0);
    let base = SmoothInput {
        label: "logarithmic sweep, A, white .05, 4 ms",
        input: Input::LogarithmicSweep,
        servo: Servo::Linear(a(), 0.0),
        noise: Noise::White(0.05),
        period_s: 0.004,
        written: 0.0,
    };
    let slow_end = Servo::Linear(a(), 0.03);
    let mut lines = vec![
        base.clone(),
        SmoothInput {
            label: "logarithmic sweep, S, white .05, 2 ms",
            servo: slow_end.clone(),
            period_s: 0.002,
            ..base.clone()
        },
        SmoothInput {
            label: "logarithmic sweep, S, AR(1) .1, 4 ms",
            servo: slow_end,
            noise: Noise::Ar1(0.1),
            ..base.clone()
        },
        SmoothInput {
            label: "sum of sines, A, white .5, 4 ms",
            input: Input::SumOfSines,
            noise: Noise::White(0.5),
            ..base.clone()
        },
        SmoothInput {
            label: "linear sweep, a lag of 25 ms 8 ms late, AR(2) .1, 5 ms",
            input: Input::LinearSweep,
            servo: Servo::Linear(Linear::first_order(1.0, 0.008, 0.025), 0.0),
            noise: Noise::Ar2(0.1),
            period_s: 0.005,
            ..base.clone()
        },
        SmoothInput {
            label: "logarithmic sweep rounded to .1, A, white .05, 4 ms",
            written: 0.1,
            ..base.clone()
        },
    ];
    let limited = Servo::Limited(Limit::Rate(250.0, 250.0));
    let others = [
        (
            "logarithmic sweep, speed limited to 250 degrees a second",
            Input::LogarithmicSweep,
            limited.clone(),
        ),
        (
            "sum of sines, speed limited to 250 degrees a second",
            Input::SumOfSines,
            limited,
        ),
        (
            "logarithmic sweep, play of 1 degree",
            Input::LogarithmicSweep,
            Servo::Limited(Limit::Play(1.0)),
        ),
        (
            "sum of sines, play of 1 degree",
            Input::SumOfSines,
            Servo::Limited(Limit::Play(1.0)),
        ),
        (
            "logarithmic sweep, play of .3 degrees",
            Input::LogarithmicSweep,
            Servo::Limited(Limit::Play(0.3)),
        ),
    ];
    lines.extend(others.map(|(label, input, servo)| SmoothInput {
        label,
        input,
        servo,
        ..base.clone()
    }));
    lines
}
