//! The expected result of identification: structure, covariance and bands.

use super::band_width::BandWidths;
use super::request::PlanRequest;
use super::simulated_runs::simulated;
use servoid_identification::results::{Bounds, Model};
use servoid_identification::thresholds::RUNS_FOR_MEAN;
use servoid_identification::{Error, Options, Record, expected_model, identify};

/// Simulated identifications. Each may choose another N: the widths are their mean, and the model shown is the
/// one with the median N.
const SIMULATIONS: u64 = 5;

/// The expected result of identification.
pub(super) struct Expectation {
    /// The widths of the bands; withdrawn where most simulated identifications gave no bounds.
    pub band: Bounds<BandWidths>,
    /// The expected model. Of a servo that is known by its model alone, it has that model's response, and the
    /// covariance of generalised least squares at the assumed noise. Of a simulated servo it is the example.
    pub model: Model,
    /// One identification of simulated runs.
    pub example: Model,
    /// The record of these runs.
    pub record: Record<'static>,
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
        let assumed = &request.assumed;
        let by_model_alone = assumed.simulation.is_none() && assumed.noise.is_none();
        let mut all = Vec::new();
        for seed in 1..=simulations {
            let record = simulated(request, seed)?;
            let example = identify(&record, &options)?;
            // The noise of a servo that is known by a model alone is known where that model has bounds.
            let known = match by_model_alone {
                true => assumed.model.level(),
                false => example.level(),
            };
            let level = known.map(|_| request.level);
            let model = expected_model(&example, &record, &assumed.model, level)?;
            all.push((model, example, record));
        }
        let is_bounded =
            |(model, ..): &(Model, Model, Record<'static>)| model.bounds.valid().is_some();
        let bounded = 2 * all.iter().filter(|one| is_bounded(one)).count() > all.len();
        let tried = all.len();
        all.retain(|one| is_bounded(one) == bounded);
        let without_bounds_percent = 100.0 * (1.0 - all.len() as f64 / tried as f64);
        all.sort_by_key(|(model, ..)| model.structure.settling_samples);
        let widths = |model: &Model| model.step.bounds.valid().map(BandWidths::of);
        let linear: Vec<_> = all.iter().filter_map(|(m, ..)| widths(m)).collect();
        let found: Vec<_> = all.iter().filter_map(|(_, e, _)| widths(e)).collect();
        let (model, example, record) = all.swap_remove(all.len() / 2);
        let level = model.level();
        let found = BandWidths {
            without_bounds_percent,
            ..BandWidths::mean(&found)
        };
        let linear = BandWidths {
            without_bounds_percent,
            ..BandWidths::mean(&linear)
        };
        if request.assumed.simulation.is_none() && request.runs >= RUNS_FOR_MEAN {
            // How runs differ, were it by chance alone, is in the bounds then.
            return Ok(Self {
                band: level.map(|_| found),
                model: example.clone(),
                example,
                record,
            });
        }
        if request.assumed.simulation.is_none() {
            return Ok(Self {
                band: level.map(|_| linear),
                model,
                example,
                record,
            });
        }
        let noise = linear.widest_percent - linear.bias_percent;
        let exceeds_noise = found.widest_percent > SCATTER * noise;
        let beyond = found.widest_percent - noise;
        Ok(Self {
            band: level.map(|_| BandWidths {
                beyond_noise_percent: if exceeds_noise { beyond } else { 0.0 },
                ..found
            }),
            model: example.clone(),
            example,
            record,
        })
    }
}
