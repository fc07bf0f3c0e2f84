//! Servos whose dynamics change from run to run, and how often the bounds of their means hold.
//!
//! Supply and temperature change gain, delay, natural frequency and damping of every run at random. The truth is the mean response of all
//! such servos, by a quadrature over what changes, and the figures are those of that mean.

use faer::c64;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use servoid_identification::results::Model;
use servoid_identification::{Options, Record, Run, identify};

use crate::limited_drive::{LimitedDrive, STROKE};
use crate::metrics_coverage::{exact_in_order, in_order};
use crate::plants::{Noise, normal, random};
use crate::servos::{Linear, figures_of};

/// Time between samples \[s\].
const PERIOD: f64 = 0.005;

/// Samples of a run.
const SAMPLES: usize = 1500;

/// The servo about which all runs lie.
#[derive(Debug, Clone, Copy)]
pub enum Kind {
    /// Natural frequency \[rad/s\] and damping.
    Second(f64, f64),
    /// Natural frequency, damping and a further lag \[s\] which does not change.
    Lagged(f64, f64, f64),
    /// One lag \[s\].
    First(f64),
    /// A drive at its limit, under strokes of one size.
    LimitedDrive,
}

/// One that a run has.
enum Servo {
    Linear(Linear),
    LimitedDrive(LimitedDrive),
}

impl Servo {
    fn gain(&self) -> f64 {
        match self {
            Self::Linear(servo) => servo.gain,
            Self::LimitedDrive(servo) => servo.gain,
        }
    }

    fn step(&self, t: f64) -> f64 {
        match self {
            Self::Linear(servo) => servo.step(t),
            Self::LimitedDrive(servo) => servo.step(t),
        }
    }

    fn response(&self, omega: f64) -> c64 {
        match self {
            Self::Linear(servo) => servo.response(omega),
            Self::LimitedDrive(servo) => servo.response(omega),
        }
    }
}

/// Standard deviations between runs.
#[derive(Debug, Clone, Copy, Default)]
pub struct Changes {
    /// Of the gain, as a share of it.
    pub gain: f64,
    /// Of the delay \[ms\].
    pub delay_ms: f64,
    /// Of the natural frequency or of a limited drive, as a share of it.
    pub frequency: f64,
    pub damping: f64,
}

impl Changes {
    /// Gain, delay, frequency, damping.
    fn in_order(self) -> [f64; 4] {
        [self.gain, self.delay_ms, self.frequency, self.damping]
    }
}

/// One line of the table.
#[derive(Debug, Clone, Copy)]
pub struct ChangingServo {
    pub kind: Kind,
    pub runs: usize,
    pub changes: Changes,
    pub noise: Noise,
    /// Factor on the noise.
    pub scale: f64,
}

/// How often the bounds of one line hold.
#[derive(Debug, Clone, Default)]
pub struct Held {
    /// Share of records that have bounds. The others are of these alone.
    pub claimed: f64,
    /// Mean share of points inside, and share of records with the whole curve inside.
    pub mean: f64,
    pub whole: f64,
    /// Mean half widths.
    pub half_widths: (f64, f64),
    /// Mean shares of frequencies at which magnitude and phase are inside.
    pub magnitude: f64,
    pub phase: f64,
    /// Share of the records with a figure inside, as in [`NAMES`](crate::metrics_coverage::NAMES).
    pub figures: [f64; 8],
}

impl ChangingServo {
    /// The servo with changes of so many standard deviations: gain, delay, frequency, damping.
    fn servo(&self, z: [f64; 4]) -> Servo {
        let [gain, delay_ms, frequency, damping] = self.changes.in_order();
        let gain = 0.97 * (1.0 + gain * z[0]);
        let delay_s = 0.0133 + 1e-3 * delay_ms * z[1];
        let faster = 1.0 + frequency * z[2];
        let second = |omega: f64, zeta: f64| {
            Linear::second_order(gain, delay_s, zeta + damping * z[3], omega * faster)
        };
        match self.kind {
            Kind::Second(omega, zeta) => Servo::Linear(second(omega, zeta)),
            Kind::Lagged(omega, zeta, lag_s) => Servo::Linear(second(omega, zeta).with_lag(lag_s)),
            Kind::First(lag_s) => Servo::Linear(Linear::first_order(gain, delay_s, lag_s / faster)),
            Kind::LimitedDrive => Servo::LimitedDrive(LimitedDrive::new(gain, delay_s, faster)),
        }
    }

    /// Servos with weights whose mean is that of all: the rule of Gauss and Hermite with three points for each change.
    fn population(&self) -> Vec<(f64, Servo)> {
        let changes = self.changes.in_order();
        let mut points = vec![(1.0, [0.0; 4])];
        for (i, _) in changes.iter().enumerate().filter(|(_, sd)| **sd > 0.0) {
            let three = |(weight, z): (f64, [f64; 4])| {
                let at = |share: f64, place: f64| {
                    let mut z = z;
                    z[i] = place;
                    (weight * share, z)
                };
                let far = 3f64.sqrt();
                [at(2.0 / 3.0, 0.0), at(1.0 / 6.0, far), at(1.0 / 6.0, -far)]
            };
            points = points.into_iter().flat_map(three).collect();
        }
        let servo = |(weight, z)| (weight, self.servo(z));
        points.into_iter().map(servo).collect()
    }

    fn record(&self, random: &mut ChaCha8Rng) -> Record<'static> {
        let runs = (0..self.runs).map(|_| {
            let servo = self.servo(std::array::from_fn(|_| normal(random)));
            let (rest, input) = self.command(random);
            let before = std::iter::once(&rest).chain(&input);
            let changes = input.iter().zip(before).map(|(now, before)| now - before);
            let edges: Vec<(usize, f64)> = changes
                .enumerate()
                .filter(|(_, size)| *size != 0.0)
                .collect();
            let noise = self.noise.samples(random, SAMPLES);
            let answer = |k: usize| -> f64 {
                let past = edges.iter().take_while(|(edge, _)| *edge <= k);
                let moved = past.map(|(edge, size)| size * servo.step((k - edge) as f64 * PERIOD));
                servo.gain() * rest + moved.sum::<f64>()
            };
            let output = noise.iter().enumerate();
            let output: Vec<f64> = output.map(|(k, v)| answer(k) + self.scale * v).collect();
            Run::new(input, output)
                .expect("one length")
                .with_input_at_rest(rest)
        });
        Record::new(PERIOD, runs.collect()).expect("it moves")
    }

    /// Levels at random, or strokes of one size to and fro; after what it was before.
    fn command(&self, random: &mut ChaCha8Rng) -> (f64, Vec<f64>) {
        let to_and_fro = matches!(self.kind, Kind::LimitedDrive);
        let shortest = if to_and_fro { 0.3 } else { 0.15 };
        let rest = if to_and_fro { -STROKE / 2.0 } else { 0.0 };
        let mut level = rest;
        let mut input = Vec::with_capacity(SAMPLES);
        while input.len() < SAMPLES {
            level = match to_and_fro {
                true => -level,
                false => random.random_range(-10.0..10.0),
            };
            let hold = random.random_range(shortest..0.5) / PERIOD;
            input.extend(std::iter::repeat_n(level, hold as usize));
        }
        input.truncate(SAMPLES);
        (rest, input)
    }

    /// Identifies so many records; record k has the seed `seed` + k.
    #[must_use]
    pub fn measure(&self, records: u64, seed: u64) -> Held {
        let truth = Truth::of(&self.population());
        let found: Vec<Option<Held>> = (0..records)
            .into_par_iter()
            .map(|k| {
                let record = self.record(&mut random(seed + k));
                truth.held_by(&identify(&record, &Options::default()).expect("well excited"))
            })
            .collect();
        let held: Vec<Held> = found.into_iter().flatten().collect();
        let mean = |of: &dyn Fn(&Held) -> f64| held.iter().map(of).sum::<f64>() / held.len() as f64;
        Held {
            claimed: held.len() as f64 / records as f64,
            mean: mean(&|held| held.mean),
            whole: mean(&|held| held.whole),
            half_widths: (
                mean(&|held| held.half_widths.0),
                mean(&|held| held.half_widths.1),
            ),
            magnitude: mean(&|held| held.magnitude),
            phase: mean(&|held| held.phase),
            figures: std::array::from_fn(|i| mean(&|held| held.figures[i])),
        }
    }
}

/// Its first columns in the table.
impl std::fmt::Display for ChangingServo {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self.kind {
            Kind::Second(omega, zeta) => write!(f, "| {omega} rad/s, damping {zeta}")?,
            Kind::Lagged(omega, zeta, lag_s) => write!(
                f,
                "| {omega} rad/s, damping {zeta}, a lag of {} ms",
                1e3 * lag_s
            )?,
            Kind::First(lag_s) => write!(f, "| a lag of {} ms", 1e3 * lag_s)?,
            Kind::LimitedDrive => write!(f, "| a limited drive, strokes of {STROKE}")?,
        }
        let [gain, delay_ms, frequency, damping] = self.changes.in_order();
        let faster = match self.kind {
            Kind::LimitedDrive => "drive",
            _ => "frequency",
        };
        let changes = [
            (gain, format!("gain {} %", 100.0 * gain)),
            (delay_ms, format!("delay {delay_ms} ms")),
            (frequency, format!("{faster} {} %", 100.0 * frequency)),
            (damping, format!("damping {damping}")),
        ];
        let changes: Vec<String> = (changes.into_iter())
            .filter_map(|(sd, words)| (sd > 0.0).then_some(words))
            .collect();
        let changes = match changes.is_empty() {
            true => "none".to_owned(),
            false => changes.join(", "),
        };
        let (noise, scale) = (self.noise, self.scale);
        write!(f, " | {scale} x {noise:?} | {} | {changes} |", self.runs)
    }
}

/// Samples after which the mean response does not move any more.
const LONG: usize = 600;

/// The mean of all servos.
struct Truth {
    step: Vec<f64>,
    figures: [f64; 8],
}

impl Truth {
    fn of(population: &[(f64, Servo)]) -> Self {
        let mean = |t: f64| {
            population
                .iter()
                .map(|(weight, servo)| weight * servo.step(t))
                .sum()
        };
        let response = |omega: f64| {
            population
                .iter()
                .map(|(weight, servo)| servo.response(omega) * *weight)
                .sum()
        };
        let gain = population
            .iter()
            .map(|(weight, servo)| weight * servo.gain())
            .sum();
        let figures = figures_of(mean, response, gain);
        Self {
            step: (0..LONG).map(|m| mean(m as f64 * PERIOD)).collect(),
            figures: exact_in_order(gain, &figures),
        }
    }

    /// What the bounds of one model hold; `None` without bounds.
    fn held_by(&self, model: &Model) -> Option<Held> {
        let bounds = model.step.bounds.valid()?;
        let last = model.step.value.len() - 1;
        // The last point is the final value.
        let at = |m: usize| {
            if m < last {
                self.step[m]
            } else {
                self.figures[0]
            }
        };
        let inside = |lower: &[f64], upper: &[f64]| {
            let points = (0..=last).filter(|&m| (lower[m]..=upper[m]).contains(&at(m)));
            points.count() as f64 / (last + 1) as f64
        };
        let (each, whole) = (&bounds.pointwise, &bounds.simultaneous);
        let [magnitude, phase] = self.frequencies_held_by(model)?;
        let figures = in_order(&model.metrics);
        let share = |inside: bool| f64::from(u8::from(inside));
        Some(Held {
            claimed: 1.0,
            mean: inside(&each.lower, &each.upper),
            whole: share(inside(&whole.lower, &whole.upper) == 1.0),
            half_widths: bounds.mean_half_widths(),
            magnitude,
            phase,
            figures: std::array::from_fn(|i| share(figures[i].contains(self.figures[i]))),
        })
    }

    /// Shares of the frequencies at which magnitude and phase of the servo's own response are inside.
    fn frequencies_held_by(&self, model: &Model) -> Option<[f64; 2]> {
        let omegas = &model.frequency.omega_rad_s;
        let own = model.servo_response(omegas).ok()?;
        let bounds = own.bounds.valid()?;
        // What frees a response of the hold of the samples.
        let freed = |own: &[f64], of_samples: &[f64], k: usize| own[k] - of_samples[k];
        let inside = omegas.iter().enumerate().map(|(k, omega)| {
            let (mut re, mut im, mut before) = (0.0, 0.0, 0.0);
            for (m, g) in self.step.iter().enumerate() {
                let angle = omega * m as f64 * PERIOD;
                re += (g - before) * angle.cos();
                im -= (g - before) * angle.sin();
                before = *g;
            }
            let decibels = 20.0 * re.hypot(im).log10()
                + freed(&own.magnitude_db, &model.frequency.magnitude_db, k);
            let phase =
                im.atan2(re).to_degrees() + freed(&own.phase_deg, &model.frequency.phase_deg, k);
            let (low, high) = (bounds.phase_deg_lower[k], bounds.phase_deg_upper[k]);
            let phase = phase + 360.0 * ((f64::midpoint(low, high) - phase) / 360.0).round();
            // Rounding at the frequency zero, where the phase is exact.
            let within = |low: f64, high: f64, x: f64| {
                f64::from(u8::from((low - 1e-9..=high + 1e-9).contains(&x)))
            };
            let (lower, upper) = (bounds.magnitude_db_lower[k], bounds.magnitude_db_upper[k]);
            [within(lower, upper, decibels), within(low, high, phase)]
        });
        let sums = inside.fold([0.0; 2], |[a, b], [x, y]| [a + x, b + y]);
        Some(sums.map(|sum| sum / omegas.len() as f64))
    }
}
