//! Simulated runs of the assumed servo.

use super::request::PlanRequest;
use crate::instrument::rig::roll_frames;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use servoid_identification::results::{Model, Noise};
use servoid_identification::{Error, Record, Run};
use servoid_protocol::Degrees;
use servoid_protocol::timing::SAMPLES_PER_FRAME;
use servoid_simulator::{SERVO_SCALE, SimulationOptions, simulate_train};

/// Samples of noise before the first one that is used: the start from zero is forgotten by then.
const RUN_UP: usize = 2_000;

/// The reference of one run, sample by sample (deg).
pub(super) fn input(request: &PlanRequest) -> Vec<f64> {
    let offsets = request.reference.offsets_us();
    let degrees = offsets.map(|offset| f64::from(offset) / request.us_per_degree);
    let samples = degrees.flat_map(|angle| [angle; SAMPLES_PER_FRAME]);
    samples.collect()
}

/// Runs of the assumed servo, from rest at neutral, as long as the reference.
pub(super) fn simulated(request: &PlanRequest, seed: u64) -> Result<Record<'static>, Error> {
    simulated_with_rest(request, 0, seed)
}

/// The same with so many frames of rest at neutral before and after the reference, as a recording has them.
pub(super) fn simulated_with_rest(
    request: &PlanRequest,
    rest: usize,
    seed: u64,
) -> Result<Record<'static>, Error> {
    let resting = || std::iter::repeat_n(0.0, rest * SAMPLES_PER_FRAME);
    let moved = input(request).into_iter();
    let input: Vec<f64> = resting().chain(moved).chain(resting()).collect();
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let runs: Result<Vec<Run>, Error> = (0..request.runs)
        .map(|run| {
            let output = match &request.assumed.simulation {
                Some(options) => {
                    let seed = options.seed.wrapping_add(1_000 * seed + run as u64);
                    let options = SimulationOptions {
                        seed,
                        ..options.clone()
                    };
                    of_simulation(request, rest, &options, &mut random)?
                }
                None => of_model(&request.assumed.model, &input, &mut random),
            };
            Run::new(input.clone(), output).map(Run::with_exact_input)
        })
        .collect();
    let assumed = &request.assumed;
    let record = Record::new(assumed.train.sample_s(), runs?)?;
    Ok(record.with_sample_phase(assumed.sample_phase_s()))
}

/// The response of the model, with its noise (deg).
fn of_model(model: &Model, input: &[f64], random: &mut ChaCha8Rng) -> Vec<f64> {
    let undisturbed = model.simulate_input(input, Some(0.0));
    let noise = coloured(random, &model.noise, input.len());
    undisturbed.iter().zip(noise).map(|(y, v)| y + v).collect()
}

/// The response of the simulated servo (deg). Its own scale is 10 µs per degree, whatever the rig's scale.
fn of_simulation(
    request: &PlanRequest,
    rest: usize,
    options: &SimulationOptions,
    random: &mut ChaCha8Rng,
) -> Result<Vec<f64>, Error> {
    let pulse = |offset: i16| SERVO_SCALE.pulse(Degrees(f64::from(offset) / request.us_per_degree));
    let train = request.assumed.train;
    let run_up = usize::from(roll_frames(train));
    let before = std::iter::repeat_n(0, run_up + rest);
    let after = std::iter::repeat_n(0, rest);
    let offsets = before.chain(request.reference.offsets_us()).chain(after);
    let pulses = offsets.map(pulse);
    // These options have made the assumed model already, so they are valid.
    let frames = simulate_train(options, train, pulses)
        .map_err(|_| Error::AllMissing { column: "output" })?;
    let frames = frames.skip(run_up);
    Ok(match &request.assumed.noise {
        None => frames.flat_map(|frame| frame.degrees()).collect(),
        Some(noise) => {
            let angles: Vec<f64> = frames.flat_map(|frame| frame.angles).collect();
            let noise = coloured(random, noise, angles.len());
            angles.iter().zip(noise).map(|(y, v)| y + v).collect()
        }
    })
}

/// Coloured noise v = ε/D(z) (deg).
fn coloured(random: &mut ChaCha8Rng, noise: &Noise, count: usize) -> Vec<f64> {
    let (ar, sigma) = (&noise.ar, noise.sigma);
    let mut values: Vec<f64> = Vec::with_capacity(RUN_UP + count);
    for _ in 0..RUN_UP + count {
        let white: f64 = StandardNormal.sample(random);
        let past = ar.iter().zip(values.iter().rev());
        values.push(sigma * white - past.map(|(d, v)| d * v).sum::<f64>());
    }
    values.split_off(RUN_UP)
}
