//! The bounds of the servo's mean, from three runs on.
//!
//! Gain and delay change from run to run, with the supply and the clock of the servo. The model of R runs has their mean, and the
//! covariance of its response x is that of the noise, V, and
//!
//! ```text
//! m_g x xᵀ + m_t (s sᵀ + b bᵀ),    s_k = (x_{k-1} - x_{k+1})/2,    b_k = (x_{k-1} - 2 x_k + x_{k+1})/2
//! ```
//!
//! at R - 1 degrees of freedom, with m_g and m_t the variances of the mean of R gains and delays, from how these differ. s is the change for a
//! delay of one sample. The model's slope is itself that of a response which came too late or too early, and at a kink another one holds a
//! sample later. With b, whose effect on a step response is half the difference of the slopes before and after a sample, the root mean square
//! of both slopes counts. No test decides whether they scatter: one that finds nothing in strong noise leaves a scatter as large as the noise
//! out. Nor is the noise subtracted from these variances: Student's t holds for the whole mean square of a few runs, and not for what is left
//! of it. The price is that noise along x and s counts twice, at once in V and in m. Two runs show that they differ, but not by how much runs
//! do.

use faer::Mat;

use crate::diagnostics::delayed_response::slope_and_bend;
use crate::diagnostics::run_scatter::RunComparison;
use crate::estimation::{GlsFit, RunSpread};
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
    let [slope, bend] = slope_and_bend(fit);
    let gain = gain.sqrt() / 100.0 / fit.variance.sqrt();
    let delay = delay.sqrt() / sample_period_s / fit.variance.sqrt();
    // What runs differ by moves no offset.
    let columns = [(gain, response), (delay, &slope[..]), (delay, &bend[..])];
    let directions = Mat::from_fn(response.len() + 1, columns.len(), |i, k| {
        let (scale, column) = columns[k];
        column.get(i).map_or(0.0, |x| scale * x)
    });
    fit.further.runs = Some(RunSpread {
        directions,
        quantities: SCATTERING,
        degrees: (count - 1) as f64,
    });
    true
}

/// Gain and delay.
const SCATTERING: usize = 2;
