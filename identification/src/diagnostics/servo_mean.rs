//! The bounds of the servo's mean, from three runs on.
//!
//! Gain and delay change from run to run, with the supply and the clock of the servo. The model of R runs has their mean, and the
//! covariance of its response x with the derivative x' is that of the noise, V, and
//!
//! ```text
//! m_g x x' + m_t x' x''
//! ```
//!
//! at R - 1 degrees of freedom, with m_g and m_t the variances of the mean of R gains and delays, from how these differ. No test
//! decides whether they scatter: one that finds nothing in strong noise leaves a scatter as large as the noise out. Nor is the noise
//! subtracted from these variances: Student's t holds for the whole mean square of a few runs, and not for what is left of it. The
//! price is that noise along x and x' counts twice, at once in V and in m. Two runs show that they differ, but not by how much runs do.

use faer::Mat;

use crate::diagnostics::run_scatter::RunComparison;
use crate::estimation::{GlsFit, RunSpread};
use crate::numerics::times;
use crate::thresholds::RUNS_FOR_MEAN;

/// Adds how `runs` differ to the covariance of `fit`; whether they are enough to say.
pub(crate) fn allow_for_scatter(
    runs: &RunComparison,
    sample_period_s: f64,
    fit: &mut GlsFit,
) -> bool {
    let count = runs.runs.len();
    if count < RUNS_FOR_MEAN {
        return false;
    }
    let gain = runs.variance_of_mean(|run| run.gain_percent);
    let delay = runs.variance_of_mean(|run| run.delay_s);
    let Some((gain, delay)) = gain.zip(delay) else {
        return false;
    };
    let response = fit.solution.response();
    let late = derivative(fit);
    let gain = gain.sqrt() / 100.0 / fit.variance.sqrt();
    let delay = delay.sqrt() / sample_period_s / fit.variance.sqrt();
    // What runs differ by moves no offset.
    let directions = Mat::from_fn(response.len() + 1, 2, |i, k| match k {
        0 => response.get(i).map_or(0.0, |x| gain * x),
        _ => late.get(i).map_or(0.0, |x| delay * x),
    });
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
