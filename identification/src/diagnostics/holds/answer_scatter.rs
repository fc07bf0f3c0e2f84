//! Answers to single commands that come sooner or later than the model says.
//!
//! Pulses with frames of their own, a logger between whose rows commands change, and a servo whose answers depend on the stroke make each
//! answer later by a time of its own. From one change of the command to the next, errors one step ahead are then
//!
//! ```text
//! ε(k) = -τ_c w(k) + independent errors,     w = D(z) s,     s(k) = (ŷ(k+1) - ŷ(k-1))/2,
//! ```
//!
//! and the model's delay is the mean of the τ_c, with the sums of w² in each hold as weights W_c. What one τ_c [varies](crate::diagnostics::holds::clustered_errors) beyond
//! chance, times sum W_c² / (sum W_c)², is the variance of this mean. It is added to the covariance, along the change that the response has for a delay.

use faer::Mat;

use super::clustered_errors::{Cluster, EffectScatter};
use super::held_run::HeldRun;
use crate::data::Hold;
use crate::diagnostics::residuals::filtered_rows::{filtered, present};
use crate::diagnostics::runs::delayed_response::slope_and_bend;
use crate::estimation::{EstimatedPart, GlsFit, noise_filter};

/// The mean of the answers takes one of them.
const FITTED: f64 = 1.0;

/// Adds the scatter of the answers of `runs` to the covariance of `fit`, where there is any beyond chance. They are a share `seen` of the record.
/// Returns the standard deviation of a time \[samples\].
pub(super) fn allow_for_answer_scatter(
    runs: &[HeldRun<'_>],
    seen: f64,
    fit: &mut GlsFit,
) -> Option<f64> {
    let answers: Vec<Cluster> = runs.iter().flat_map(|run| answers(run, &fit.ar)).collect();
    let scatter = EffectScatter::of(&answers, FITTED)?;
    let variance = seen * scatter.variance / scatter.count / fit.variance;
    let [slope, bend] = slope_and_bend(fit);
    let size = slope.len();
    let covariance = Mat::from_fn(size + 1, size + 1, |i, j| match (i, j) {
        (i, j) if i < size && j < size => variance * (slope[i] * slope[j] + bend[i] * bend[j]),
        _ => 0.0,
    });
    fit.spread_by(EstimatedPart {
        covariance,
        relative_variance: scatter.relative_variance(),
    });
    Some(scatter.variance.sqrt())
}

/// The errors of each answer.
fn answers(held: &HeldRun<'_>, ar: &[f64]) -> Vec<Cluster> {
    let speed: Vec<f64> = held.run.speed().into_iter().map(present).collect();
    let weights = filtered(&speed, &noise_filter(ar));
    let of_hold = |hold: &Hold| {
        let samples = hold.samples.clone();
        Cluster::of_rows(&weights[samples.clone()], &held.errors[samples])
    };
    held.holds.iter().map(of_hold).collect()
}
