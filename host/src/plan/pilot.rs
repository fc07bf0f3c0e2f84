//! Simulated runs for the structure, and the covariance that they will have.

use super::{Question, Widths};
use crate::instrument::rig::capture::ROLL_FRAMES;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use servoid_identification::fsf_basis::FsfBasis;
use servoid_identification::gls::{self, GlsOptions};
use servoid_identification::least_squares::{Coordinates, Information};
use servoid_identification::model::ParameterBounds;
use servoid_identification::moments::Moments;
use servoid_identification::step_response::{StepBounds, StepResponse};
use servoid_identification::variance::{self, CurveVariance};
use servoid_identification::{Error, Model, NoiseOrder, Options, Record, Run, identify};
use servoid_protocol::Degrees;
use servoid_protocol::timing::{SAMPLE_US, SAMPLES_PER_FRAME};
use servoid_simulator::{SERVO_SCALE, SimulationOptions, simulate};

/// Simulated identifications. Each may choose another N: widths are the mean over them, and the one with
/// the middle N is shown.
const PILOTS: u64 = 5;

/// Samples of noise that pass before the first one that is used: its start is forgotten.
const RUN_UP: usize = 2_000;

/// What is to be expected of a run.
pub(super) struct Expected {
    /// How wide the bands will be; `None` where most pilots have found their errors to be no noise, as the
    /// runs themselves will be found.
    pub band: Option<Widths>,
    /// A model as it will be. Of a servo that is known by its model alone: its response, with the covariance
    /// that generalised least squares has at the assumed noise. Of a simulated one: the pilot.
    pub model: Model,
    /// One identification of a simulated run.
    pub pilot: Model,
    /// The record that the pilot is from.
    pub record: Record,
}

/// Widths of single runs scatter by some 20 %: more than this much beyond what noise explains is the
/// servo's own.
const SCATTER: f64 = 1.25;

impl Expected {
    pub(super) fn of(question: &Question) -> Result<Self, Error> {
        Self::of_pilots(question, PILOTS)
    }

    /// As [`Expected::of`], from so many pilots.
    pub(super) fn of_pilots(question: &Question, pilots: u64) -> Result<Self, Error> {
        let options = Options {
            level: question.level,
            ..Options::default()
        };
        let mut all = Vec::new();
        for seed in 1..=pilots {
            let record = simulated(question, seed)?;
            let pilot = identify(&record, &options)?;
            let model = with_known_noise(question, &pilot, &record)?;
            all.push((model, pilot, record));
        }
        let pilots = all.len();
        let is_bounded = |(model, ..): &(Model, Model, Record)| model.bounds.valid().is_some();
        let bounded = 2 * all.iter().filter(|pilot| is_bounded(pilot)).count() > pilots;
        if bounded {
            all.retain(is_bounded);
        }
        all.sort_by_key(|(model, ..)| model.structure.settling_samples);
        let widths = |model: &Model| model.step.bounds.valid().map(Widths::of);
        let linear: Vec<_> = all.iter().filter_map(|(m, ..)| widths(m)).collect();
        let found: Vec<_> = all.iter().filter_map(|(_, p, _)| widths(p)).collect();
        let (model, pilot, record) = all.swap_remove(all.len() / 2);
        let linear = Widths::mean(&linear);
        if question.assumed.simulation.is_none() {
            return Ok(Self {
                band: bounded.then_some(linear),
                model,
                pilot,
                record,
            });
        }
        let found = Widths::mean(&found);
        let noise = linear.widest_percent - linear.bias_percent;
        let is_its_own = found.widest_percent > SCATTER * noise;
        let beyond = found.widest_percent - noise;
        Ok(Self {
            band: bounded.then_some(Widths {
                beyond_noise_percent: if is_its_own { beyond } else { 0.0 },
                ..found
            }),
            model: pilot.clone(),
            pilot,
            record,
        })
    }
}

/// The input of one run at the times of its samples (deg).
pub(super) fn input(question: &Question) -> Vec<f64> {
    let offsets = question.reference.offsets_us();
    let degrees = offsets.map(|offset| f64::from(offset) / question.us_per_degree);
    degrees
        .flat_map(|angle| [angle; SAMPLES_PER_FRAME])
        .collect()
}

/// Runs of the assumed servo, which comes from rest at neutral.
pub(super) fn simulated(question: &Question, seed: u64) -> Result<Record, Error> {
    let input = input(question);
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let runs: Result<Vec<Run>, Error> = (0..question.runs)
        .map(|run| {
            let output = match &question.assumed.simulation {
                Some(options) => {
                    let seed = options.seed.wrapping_add(1_000 * seed + run as u64);
                    let options = SimulationOptions {
                        seed,
                        ..options.clone()
                    };
                    played(question, &options, &mut random)?
                }
                None => of_model(&question.assumed.model, &input, &mut random),
            };
            Run::new(input.clone(), output)
        })
        .collect();
    Record::new(f64::from(SAMPLE_US) * 1e-6, runs?)
}

/// The answer of the model, in its noise (deg).
fn of_model(model: &Model, input: &[f64], random: &mut ChaCha8Rng) -> Vec<f64> {
    let undisturbed = model.simulate_input(input, Some(0.0));
    let noise = noise(random, model, input.len());
    undisturbed.iter().zip(noise).map(|(y, v)| y + v).collect()
}

/// The answer of the simulated servo, of which a microsecond is a tenth of a degree whatever the rig's own
/// scale (deg).
fn played(
    question: &Question,
    options: &SimulationOptions,
    random: &mut ChaCha8Rng,
) -> Result<Vec<f64>, Error> {
    let pulse =
        |offset: i16| SERVO_SCALE.pulse(Degrees(f64::from(offset) / question.us_per_degree));
    let rest = usize::from(ROLL_FRAMES);
    let neutral = std::iter::repeat_n(0, rest);
    let pulses = neutral.chain(question.reference.offsets_us()).map(pulse);
    // The assumed model has been made with these options already: they are sound.
    let frames = simulate(options, pulses).map_err(|_| Error::AllMissing { column: "output" })?;
    let mut output = Vec::new();
    for frame in frames.skip(rest) {
        match question.assumed.white_noise {
            None => output.extend(frame.degrees()),
            Some(sigma) => output.extend(frame.angles.map(|angle| {
                let white: f64 = StandardNormal.sample(random);
                angle + sigma * white
            })),
        }
    }
    Ok(output)
}

/// v = ε/D(z).
fn noise(random: &mut ChaCha8Rng, model: &Model, count: usize) -> Vec<f64> {
    let (ar, sigma) = (&model.noise.ar, model.noise.sigma);
    let mut noise: Vec<f64> = Vec::with_capacity(RUN_UP + count);
    for _ in 0..RUN_UP + count {
        let white: f64 = StandardNormal.sample(random);
        let past = ar.iter().zip(noise.iter().rev());
        noise.push(sigma * white - past.map(|(d, v)| d * v).sum::<f64>());
    }
    noise.split_off(RUN_UP)
}

/// The pilot's model with the assumed servo's response and the covariance of the assumed noise.
fn with_known_noise(question: &Question, pilot: &Model, record: &Record) -> Result<Model, Error> {
    let truth = &question.assumed.model;
    let basis = pilot.basis()?;
    let (settling, order) = (basis.settling(), truth.noise.ar.len());
    let information =
        Information::from_moments(Moments::of_record(record, settling + order, order + 1));
    let coordinates = Coordinates::new(basis);
    let options = GlsOptions {
        order: NoiseOrder::Order(order),
        start: truth.noise.ar.clone(),
        ..GlsOptions::default()
    };
    let not_excited = || Error::NotExcited {
        asked: basis.frequencies(),
        excited: 1,
        highest_hz: 0.0,
    };
    let mut fit = gls::fit(&information, &coordinates, &options).ok_or_else(not_excited)?;
    // How well D itself will be known is the fit's; D and σ are the assumed ones.
    fit.ar.clone_from(&truth.noise.ar);
    fit.variance = truth.noise.sigma.powi(2);
    fit.solution = information
        .solve(&coordinates, &fit.ar)
        .ok_or_else(not_excited)?;
    let spread: CurveVariance = variance::spread(&information, &fit, &coordinates.step_map());
    let last = truth.step.value.last().copied().unwrap_or(0.0);
    let mut value: Vec<f64> = truth.step.value.iter().copied().take(settling).collect();
    value.resize(settling, last);
    // The last one is the final value, whatever the response is at that time.
    if let Some(final_value) = value.last_mut() {
        *final_value = last;
    }
    let covariance = fit.covariance();
    let n = basis.frequencies();
    let rows = || (0..n).map(|i| (0..n).map(|j| covariance[(i, j)]).collect());
    let theta = parameters(&basis, &value);
    // The bounds hold if those of the pilot do.
    let step_bounds = pilot.step.bounds.as_ref().map(|known| {
        let biases = known.biases();
        StepBounds::new(&value, &spread, question.level, biases)
    });
    Ok(Model {
        theta,
        bounds: pilot.level().map(|level| ParameterBounds {
            level,
            covariance: rows().collect(),
        }),
        noise: truth.noise.clone(),
        step: StepResponse::new(pilot.sample_period_s, value, step_bounds),
        ..pilot.clone()
    })
}

/// The parameters theta of which a step response is made.
fn parameters(basis: &FsfBasis, step: &[f64]) -> Vec<f64> {
    let analysis = basis.analysis_map();
    let before = std::iter::once(&0.0).chain(step);
    let impulse: Vec<f64> = step
        .iter()
        .zip(before)
        .map(|(g, before)| g - before)
        .collect();
    let of_row = |row| {
        impulse
            .iter()
            .zip(0..)
            .map(|(h, k)| analysis[(row, k)] * h)
            .sum()
    };
    (0..basis.frequencies()).map(of_row).collect()
}
