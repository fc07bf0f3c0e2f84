//! The bands of one who knows what identification has to find: the settling time and the noise.

use servoid_identification::results::{self, Bounds};
use servoid_identification::{NoiseOrder, Options, Settling, expected_model, identify};

use crate::plants::Noise;
use crate::trial::Trial;

/// Share of the final value within which an exact response counts as settled.
const SETTLED: f64 = 1e-3;

/// Longest settling time that identification considers \[samples\].
const LONGEST: usize = 599;

/// Level of the bands.
const LEVEL: f64 = 0.99;

/// Mean half widths, of points and of the whole curve, of generalised least squares with the exact settling time and the noise, `scale`
/// times as large, of a record of which nothing has to be taken out. `None` where no model has such noise.
pub(crate) fn half_widths(trial: &Trial, noise: Noise, scale: f64) -> Option<(f64, f64)> {
    let noise = modelled(noise, scale)?;
    let options = Options {
        settling: Settling::Samples(settled_after(&trial.truth).min(LONGEST) | 1),
        noise_order: NoiseOrder::Order(noise.ar.len()),
        ..Options::default()
    };
    let example = identify(&trial.record, &options).ok()?;
    let truth = results::Model {
        noise,
        ..example.clone()
    };
    let model = expected_model(&example, &trial.record, &truth, Bounds::Valid(LEVEL)).ok()?;
    Some(model.step.bounds.valid()?.mean_half_widths())
}

/// As a model has it; `None` where a model can only approximate it.
fn modelled(noise: Noise, scale: f64) -> Option<results::Noise> {
    let (ar, moving_average, sd) = noise.numbers();
    (moving_average == 0.0).then(|| results::Noise {
        ar: ar.to_vec(),
        sigma: scale * sd,
    })
}

/// Samples after which `response` stays within [`SETTLED`] of its final value, one.
fn settled_after(response: &[f64]) -> usize {
    let moving = response.iter().rposition(|g| (g - 1.0).abs() > SETTLED);
    moving.map_or(1, |m| m + 2)
}
