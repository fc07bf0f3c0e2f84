//! The bounds of the servo's mean, from three runs on.
//!
//! Gain, delay and offset change from run to run, with the supply and the clock of the servo. The model of R runs has their
//! mean, whose covariance about that of the servo is
//!
//! ```text
//! V + (s_g² x x' + s_t² x' x'')/R
//! ```
//!
//! with V of the noise, the response x, its derivative x' and the scatter s_g, s_t between runs, at R - 1 degrees of freedom
//! (a mixed model, by the method of moments). Two runs show that they differ, but not by how much runs do.

use faer::Mat;

use crate::diagnostics::run_scatter::{RunComparison, Scatter};
use crate::estimation::{GlsFit, RunSpread};
use crate::numerics::times;
use crate::thresholds::{RUNS_FOR_MEAN, SCATTER_SIGNIFICANCE};

/// Adds the scatter of `runs` to the covariance of `fit`, where it is beyond chance; whether it is.
pub(crate) fn allow_for_scatter(
    runs: &RunComparison,
    sample_period_s: f64,
    fit: &mut GlsFit,
) -> bool {
    let count = runs.runs.len();
    let beyond_chance = |scatter: &Scatter| match scatter.p < SCATTER_SIGNIFICANCE {
        true => scatter.sd,
        false => 0.0,
    };
    let gain = beyond_chance(&runs.gain_percent) / 100.0;
    let delay = beyond_chance(&runs.delay_s) / sample_period_s;
    let offset = beyond_chance(&runs.offset);
    if count < RUNS_FOR_MEAN || gain + delay + offset == 0.0 {
        return false;
    }
    let response = fit.solution.response();
    let p = response.len();
    let late = derivative(fit);
    let scale = (count as f64 * fit.variance).sqrt().recip();
    let moved = |part: &[f64], size: f64, offset: f64| -> Vec<f64> {
        let part = part.iter().map(|x| scale * size * x);
        part.chain([scale * offset]).collect()
    };
    let all = [
        (gain > 0.0).then(|| moved(response, gain, 0.0)),
        (delay > 0.0).then(|| moved(&late, delay, 0.0)),
        (offset > 0.0).then(|| moved(&vec![0.0; p], 0.0, offset)),
    ];
    let all: Vec<Vec<f64>> = all.into_iter().flatten().collect();
    let directions = Mat::from_fn(p + 1, all.len(), |i, k| all[k][i]);
    fit.further.runs = Some(RunSpread {
        directions,
        degrees: (count - 1) as f64,
    });
    true
}

/// The change of the response for a delay of one sample, in the coordinates of the fit.
fn derivative(fit: &GlsFit) -> Vec<f64> {
    let impulse = fit.impulse();
    let at = |k: usize| impulse.get(k).copied().unwrap_or(0.0);
    let slope: Vec<f64> = (0..impulse.len())
        .map(|k| (at(k.wrapping_sub(1)) - at(k + 1)) / 2.0)
        .collect();
    match fit.coordinates.impulse_map() {
        None => slope,
        Some(_) => times(&fit.coordinates.basis.analysis_map(), &slope),
    }
}
