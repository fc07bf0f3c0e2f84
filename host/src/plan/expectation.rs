//! The expected result of identification: structure, covariance and bands.

use super::band_width::BandWidths;
use super::request::PlanRequest;
use super::simulated_runs::simulated;
use servoid_identification::results::Model;
use servoid_identification::{Error, Options, Record, expected_model, identify};

/// Simulated identifications. Each may choose another N: the widths are their mean, and the model shown is the
/// one with the median N.
const SIMULATIONS: u64 = 5;

/// The expected result of identification.
pub(super) struct Expectation {
    /// The widths of the bands; `None` where most simulated identifications gave no bounds.
    pub band: Option<BandWidths>,
    /// The expected model. Of a servo that is known by its model alone, it has that model's response, and the
    /// covariance of generalised least squares at the assumed noise. Of a simulated servo it is the example.
    pub model: Model,
    /// One identification of simulated runs.
    pub example: Model,
    /// The record of these runs.
    pub record: Record,
}

/// Widths of single runs scatter by some 20 %. A band wider than this factor times its noise part is wider
/// because the servo is not linear.
const SCATTER: f64 = 1.25;

impl Expectation {
    pub(super) fn of(request: &PlanRequest) -> Result<Self, Error> {
        Self::of_simulations(request, SIMULATIONS)
    }

    /// As [`Expectation::of`], from this number of simulations.
    pub(super) fn of_simulations(request: &PlanRequest, simulations: u64) -> Result<Self, Error> {
        let options = Options {
            level: request.level,
            ..Options::default()
        };
        let mut all = Vec::new();
        for seed in 1..=simulations {
            let record = simulated(request, seed)?;
            let example = identify(&record, &options)?;
            let model = expected_model(&example, &record, &request.assumed.model, request.level)?;
            all.push((model, example, record));
        }
        let is_bounded = |(model, ..): &(Model, Model, Record)| model.bounds.valid().is_some();
        let bounded = 2 * all.iter().filter(|one| is_bounded(one)).count() > all.len();
        if bounded {
            all.retain(is_bounded);
        }
        all.sort_by_key(|(model, ..)| model.structure.settling_samples);
        let widths = |model: &Model| model.step.bounds.valid().map(BandWidths::of);
        let linear: Vec<_> = all.iter().filter_map(|(m, ..)| widths(m)).collect();
        let found: Vec<_> = all.iter().filter_map(|(_, e, _)| widths(e)).collect();
        let (model, example, record) = all.swap_remove(all.len() / 2);
        let linear = BandWidths::mean(&linear);
        if request.assumed.simulation.is_none() {
            return Ok(Self {
                band: bounded.then_some(linear),
                model,
                example,
                record,
            });
        }
        let found = BandWidths::mean(&found);
        let noise = linear.widest_percent - linear.bias_percent;
        let exceeds_noise = found.widest_percent > SCATTER * noise;
        let beyond = found.widest_percent - noise;
        Ok(Self {
            band: bounded.then_some(BandWidths {
                beyond_noise_percent: if exceeds_noise { beyond } else { 0.0 },
                ..found
            }),
            model: example.clone(),
            example,
            record,
        })
    }
}

/// The example's structure with the assumed servo's response and the covariance of the assumed noise.
fn with_assumed_noise(
    request: &PlanRequest,
    example: &Model,
    record: &Record,
) -> Result<Model, Error> {
    let truth = &request.assumed.model;
    let basis = example.basis()?;
    let (settling, order) = (basis.settling(), truth.noise.ar.len());
    let information =
        RowInformation::from_moments(Moments::of_record(record, settling + order, order + 1));
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
    // The covariance of D is the fit's; D and σ are the assumed ones.
    fit.ar.clone_from(&truth.noise.ar);
    fit.variance = truth.noise.sigma.powi(2);
    fit.solution = information
        .solve(&coordinates, &fit.ar)
        .ok_or_else(not_excited)?;
    let spread = CurveVariance::of_fit(&information, &fit, &coordinates.step_map());
    let last = truth.step.value.last().copied().unwrap_or(0.0);
    let mut value: Vec<f64> = truth.step.value.iter().copied().take(settling).collect();
    value.resize(settling, last);
    // The last element is the final value by definition.
    if let Some(final_value) = value.last_mut() {
        *final_value = last;
    }
    let covariance = fit.covariance();
    let n = basis.frequencies();
    let rows = (0..n).map(|i| (0..n).map(|j| covariance[(i, j)]).collect());
    let theta = parameters(&basis, &value);
    // The bounds hold if those of the example do, and if the noise of a servo that is known by its model alone is
    // noise.
    let assumed = &request.assumed;
    let level = match assumed.simulation.is_none() && assumed.white_noise.is_none() {
        true => truth.level().zip(example.level()).map(|(_, level)| level),
        false => example.level(),
    };
    let step_bounds = level.zip(example.step.bounds.as_ref()).map(|(_, known)| {
        let biases = known.biases();
        StepBounds::new(&value, &spread, request.level, biases)
    });
    Ok(Model {
        theta,
        bounds: level.map(|level| ParameterBounds {
            level,
            covariance: rows.collect(),
        }),
        noise: truth.noise.clone(),
        step: StepResponse::new(example.sample_period_s, value, step_bounds),
        ..example.clone()
    })
}

/// The parameters theta of a step response.
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
