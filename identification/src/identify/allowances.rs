//! What bounds allow for beside noise: frequencies that the bank leaves out, and the steps of the sensor.

use super::fitted::Fitted;
use super::responses::Responses;
use super::task::Task;
use crate::data::Quantisation;
use crate::estimation::Truncation;
use crate::numerics::not_negative;
use crate::results::Biases;

pub(super) struct Allowances {
    /// Bounds of the errors of the step response.
    pub(super) step: Biases,
    /// Bounds of the errors of the frequency response; empty where there are none.
    pub(super) frequency: Vec<f64>,
    /// Whether the effect of left-out frequencies has a bound.
    pub(super) bounded: bool,
    /// The steps of the sensor, where they are larger than the noise.
    pub(super) quantisation: Option<Quantisation>,
}

impl Allowances {
    pub(super) fn new(task: &Task<'_>, fitted: &Fitted, responses: &Responses) -> Self {
        let quantisation = task
            .record
            .and_then(|record| fitted.estimate.steps_of_sensor(record));
        let basis = fitted.candidate.plan.basis;
        let (truncation, mut frequency, bounded) = if basis.is_complete() {
            (0.0, Vec::new(), true)
        } else {
            match truncation(fitted, responses) {
                Some(found) => (found.step, found.frequency, true),
                None => unbounded(responses),
            }
        };
        if let Some(found) = quantisation {
            frequency.resize(responses.omegas.len(), 0.0);
            for (bias, omega) in frequency.iter_mut().zip(&responses.omegas) {
                *bias += found.allowance_at(*omega, basis.settling());
            }
        }
        Self {
            step: Biases {
                truncation,
                rounding: quantisation.map_or(0.0, |found| found.allowance),
            },
            frequency,
            bounded,
            quantisation,
        }
    }
}

/// Bounds of the effects of the frequencies that the bank leaves out; `None` where there is no bound.
fn truncation(fitted: &Fitted, responses: &Responses) -> Option<Truncation> {
    let (plan, estimate) = (&fitted.candidate.plan, &fitted.estimate);
    let (theta, covariance) = (estimate.fit.theta(), estimate.fit.covariance());
    let sd: Vec<f64> = (0..theta.len())
        .map(|k| not_negative(covariance[(k, k)]).sqrt())
        .collect();
    Truncation::new(
        &estimate.information.moments,
        &plan.basis,
        &estimate.fit.ar,
        (&theta, &sd),
        plan.roll_off,
        &responses.omegas,
    )
}

/// An effect without a bound is taken to be as large as the response itself: then any phase is possible.
fn unbounded(responses: &Responses) -> (f64, Vec<f64>, bool) {
    let largest = |values: &[f64]| values.iter().fold(0.0f64, |a, x| a.max(x.abs()));
    // Twice the larger of two parts is more than their length.
    let frequency = 2.0 * largest(&responses.frequency_values);
    (
        largest(&responses.step_values),
        vec![frequency; responses.omegas.len()],
        false,
    )
}
