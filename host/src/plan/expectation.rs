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

/// One simulated identification.
struct Simulated {
    /// What is expected of noise alone.
    expected: Model,
    example: Model,
    record: Record<'static>,
}

impl Simulated {
    fn of(request: &PlanRequest, seed: u64) -> Result<Self, Error> {
        let options = Options {
            level: request.level,
            ..Options::default()
        };
        let assumed = &request.assumed;
        let by_model_alone = assumed.simulation.is_none() && assumed.noise.is_none();
        let record = simulated(request, seed)?;
        let example = identify(&record, &options)?;
        // The noise of a servo that is known by a model alone is known where that model has bounds.
        let known = match by_model_alone {
            true => assumed.model.level(),
            false => example.level(),
        };
        let level = known.map(|_| request.level);
        Ok(Self {
            expected: expected_model(&example, &record, &assumed.model, level)?,
            example,
            record,
        })
    }

    /// Whether both have bounds, or the expected model where the example is not what counts.
    fn level(&self, by_example: bool) -> Bounds<f64> {
        match self.expected.level() {
            Bounds::Valid(_) if by_example => self.example.level(),
            level => level,
        }
    }
}

/// The mean widths of models, as far as they have bounds.
fn mean_widths<'m>(models: impl Iterator<Item = &'m Model>) -> BandWidths {
    let widths = models.filter_map(|model| model.step.bounds.valid().map(BandWidths::of));
    BandWidths::mean(&widths.collect::<Vec<_>>())
}

impl Expectation {
    pub(super) fn of(request: &PlanRequest) -> Result<Self, Error> {
        Self::of_simulations(request, SIMULATIONS)
    }

    /// As [`Expectation::of`], from this number of simulations.
    pub(super) fn of_simulations(request: &PlanRequest, simulations: u64) -> Result<Self, Error> {
        let all = (1..=simulations).map(|seed| Simulated::of(request, seed));
        let mut all = all.collect::<Result<Vec<_>, _>>()?;
        let is_simulated = request.assumed.simulation.is_some();
        // More than noise is in the bounds of a servo that is not linear, and how runs differ in those of several.
        let by_example = is_simulated || request.runs >= RUNS_FOR_MEAN;
        let is_bounded = |one: &Simulated| one.level(by_example).valid().is_some();
        let with_bounds = all.iter().filter(|one| is_bounded(one)).count();
        let without_bounds_percent = 100.0 * (1.0 - with_bounds as f64 / all.len() as f64);
        let bounded = 2 * with_bounds > all.len();
        all.retain(|one| is_bounded(one) == bounded);
        all.sort_by_key(|one| one.expected.structure.settling_samples);
        let linear = mean_widths(all.iter().map(|one| &one.expected));
        let found = mean_widths(all.iter().map(|one| &one.example));
        let noise = linear.widest_percent - linear.bias_percent;
        let repeats = is_simulated && found.widest_percent > SCATTER * noise;
        let widths = BandWidths {
            without_bounds_percent,
            beyond_noise_percent: match repeats {
                true => found.widest_percent - noise,
                false => 0.0,
            },
            ..if by_example { found } else { linear }
        };
        let median = all.swap_remove(all.len() / 2);
        Ok(Self {
            band: median.level(by_example).map(|_| widths),
            model: match by_example {
                true => median.example.clone(),
                false => median.expected,
            },
            example: median.example,
            record: median.record,
        })
    }
}
