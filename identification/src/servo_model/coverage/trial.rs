//! One recording of a servo: what the fit claims of it, and whether that is so.

use super::references::{FRAME, NoiseKind, PERIOD_S, Reference};
use super::servos::{Kind, servo};
use super::truth::{Beyond, Truth};
use crate::data::{Record, Run};
use crate::results::Interval;
use crate::servo_model::{ServoModel, ServoModelOptions, fit, quantities};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Samples of a recording.
const SAMPLES: usize = 3600;

/// Samples of a new command.
const NEW_SAMPLES: usize = 1500;

/// Rounding by which a response may miss a band of no width.
const ROUNDING: f64 = 1e-9;

/// What is recorded.
#[derive(Clone, Copy, Debug)]
pub(super) struct Case {
    pub(super) kind: Kind,
    /// Number of the servo.
    pub(super) servo: u64,
    pub(super) reference: Reference,
    pub(super) noise: NoiseKind,
    /// Number of the recording of this servo.
    pub(super) run: u64,
    /// Percent of the rows that are missing.
    pub(super) missing_percent: u64,
    /// Whether commands wait for the next of pulses that come every frame, at moments of their own.
    pub(super) waits_for_pulses: bool,
}

/// The fit of a recording, and what is true.
pub(super) struct Trial {
    pub(super) case: Case,
    pub(super) truth: Truth,
    pub(super) found: ServoModel,
    /// How much worse than the truth it describes the record: difference of the sums of squares of white errors, each of
    /// variance 1. Least squares with the right terms give minus their number; no test finds a misfit that is small.
    pub(super) misfit: f64,
    /// What it says where it gives intervals; `None` where they are withdrawn.
    pub(super) claim: Option<Claim>,
}

/// Whether what is claimed holds.
pub(super) struct Claim {
    /// Of each determined quantity that has a truth.
    pub(super) intervals: Vec<Judged>,
    /// Under another command of the recorded kind; `None` where it moves the servo much faster than the record.
    pub(super) alike: Option<Band>,
    /// Under random levels, whose strokes may be larger than any that was recorded.
    pub(super) large: Option<Band>,
}

/// An interval and the truth.
#[derive(Clone, Copy, Debug)]
pub(super) struct Judged {
    /// The quantity.
    pub(super) name: &'static str,
    pub(super) truth: f64,
    pub(super) interval: Interval,
}

impl Judged {
    /// Whether the interval holds the truth.
    pub(super) fn holds(&self) -> bool {
        self.interval.contains(self.truth)
    }
}

/// Whether the band of the response to a new command holds the true response.
#[derive(Clone, Copy)]
pub(super) struct Band {
    /// Share of the samples where it does.
    pub(super) inside: f64,
    /// Largest distance of the truth from it \[deg\].
    pub(super) farthest: f64,
}

impl Case {
    /// The servo, its recording and the noise in it.
    fn recorded(&self) -> (Truth, Record<'static>, Vec<f64>) {
        let truth = servo(self.kind, self.servo);
        let stream = 10_000 * self.run + 10 * self.reference as u64 + self.noise as u64;
        let mut random = ChaCha8Rng::seed_from_u64(self.servo);
        random.set_stream(stream);
        let mut input = self.reference.command(&mut random, SAMPLES);
        let noise = self.noise.draw(&mut random, input.len());
        let clean = match self.waits_for_pulses {
            true => truth.response(&at_pulses(&input, random.random_range(0..FRAME)), PERIOD_S),
            false => truth.response(&input, PERIOD_S),
        };
        let mut output: Vec<f64> = clean.iter().zip(&noise).map(|(y, v)| y + v).collect();
        let at_rest = input[0];
        for (u, y) in input.iter_mut().zip(&mut output).skip(1) {
            if random.random_range(0..100) < self.missing_percent {
                (*u, *y) = (f64::NAN, f64::NAN);
            }
        }
        let run = Run::new(input, output).expect("as many outputs as inputs");
        let run = run.with_input_at_rest(at_rest);
        let record = Record::new(PERIOD_S, vec![run]).expect("one run");
        (truth, record, noise)
    }

    fn claim(&self, truth: &Truth, found: &ServoModel) -> Option<Claim> {
        let mut random = ChaCha8Rng::seed_from_u64(self.servo);
        random.set_stream(u64::MAX);
        let alike = self.reference.another(&mut random, NEW_SAMPLES);
        let large = Reference::RandomLevels.another(&mut random, NEW_SAMPLES);
        found.covariance.valid().map(|_| Claim {
            intervals: intervals(truth, found),
            alike: band(truth, found, &alike),
            large: band(truth, found, &large),
        })
    }

    /// Records the servo, and fits it.
    pub(super) fn trial(self) -> Trial {
        let (truth, record, noise) = self.recorded();
        let found = fit(&record, &ServoModelOptions::default()).expect("samples enough");
        let claim = self.claim(&truth, &found);
        let simulated = found.simulate(&record, &[]);
        let measured = record.runs()[0].output().iter();
        let errors: Vec<f64> = measured.zip(&simulated[0]).map(|(y, s)| y - s).collect();
        let misfit =
            self.noise.white_squares(&errors, &errors) - self.noise.white_squares(&noise, &errors);
        Trial {
            case: self,
            misfit,
            truth,
            found,
            claim,
        }
    }
}

/// The command that the servo has, of pulses whose first comes with sample `first`: until then that of the rest before.
fn at_pulses(input: &[f64], first: usize) -> Vec<f64> {
    let pulse_before = |k: usize| k.checked_sub(first).map(|since| k - since % FRAME);
    let command = |k: usize| input[pulse_before(k).unwrap_or(0)];
    (0..input.len()).map(command).collect()
}

/// The band of the response to `input`; `None` where it is withdrawn.
fn band(truth: &Truth, found: &ServoModel, input: &[f64]) -> Option<Band> {
    let response = found.respond(input, 0);
    let half_width = response.half_width.valid()?;
    let truths = truth.response(input, PERIOD_S);
    let middles = response.value.iter().zip(&truths);
    let beyond: Vec<f64> = middles
        .zip(half_width)
        .map(|((value, truth), half)| (value - truth).abs() - half)
        .collect();
    let inside = beyond.iter().filter(|beyond| **beyond <= ROUNDING).count();
    Some(Band {
        inside: inside as f64 / input.len() as f64,
        farthest: beyond.iter().fold(0.0, |a: f64, b| a.max(*b)),
    })
}

/// The intervals of quantities that are determined and whose truth is known.
fn intervals(truth: &Truth, found: &ServoModel) -> Vec<Judged> {
    let judged = |(name, truth): (&'static str, f64)| {
        let mut all = found.quantities.iter();
        let quantity = all.find(|found| found.name == name && found.determined)?;
        Some(Judged {
            name,
            truth,
            interval: *quantity.interval.valid()?,
        })
    };
    truths(truth, found)
        .into_iter()
        .filter_map(judged)
        .collect()
}

/// The true quantities by name: of what the equation cannot be only those whose meaning does not depend on it. A lag of the drive is in the delay.
fn truths(truth: &Truth, found: &ServoModel) -> Vec<(&'static str, f64)> {
    let middle = found.commands.map_or(0.0, |commands| commands.middle());
    let mut all = quantities::values(&truth.point, middle);
    if let Beyond::DriveLag { lag_s } = truth.beyond {
        for (name, value) in &mut all {
            if *name == "delay" {
                *value += lag_s;
            }
        }
        return all;
    }
    let is_of_equation = truth.beyond == Beyond::Nothing;
    all.retain(|(name, _)| is_of_equation || matches!(*name, "delay" | "gain" | "offset"));
    if !is_of_equation {
        all.push(("top speed upwards", truth.top_speed(true)));
        all.push(("top speed downwards", truth.top_speed(false)));
    }
    if let Beyond::Stiction { excess, .. } = truth.beyond {
        let servo = truth.point.physics(0, |_, value| value);
        let coulomb = servo.friction.map_or(0.0, |friction| friction.coulomb);
        all.push((
            "resting error by friction",
            (1.0 + excess) * coulomb / servo.stiffness,
        ));
    }
    all
}
