//! The model with its bounds and metrics, and the explanation of its structure.

use super::allowances::Allowances;
use super::assess::figures_of_merit;
use super::fitted::Fitted;
use super::responses::Responses;
use super::task::Task;
use crate::data::Timing;
use crate::diagnostics::{Explanation, RunComparison, contradicted_rest};
use crate::estimation::{Excitation, Noise};
use crate::numerics::matrix_rows::to_rows;
use crate::results::{
    Bounds, FrequencyBounds, FrequencyResponse, MODEL_SCHEMA, Measured, Metrics, Model,
    ParameterBounds, Residuals, StepBounds, StepResponse, Structure,
};

/// The model without tests of its residuals and advice.
pub(super) fn model(
    task: &Task<'_>,
    fitted: &Fitted,
    responses: &Responses,
    allowances: &Allowances,
) -> Model {
    let (plan, moments) = (&fitted.candidate.plan, &fitted.candidate.moments);
    let (information, fit) = (&fitted.estimate.information, &fitted.estimate.fit);
    let (basis, level) = (&plan.basis, task.options.level);
    let timing = Timing {
        sample_period_s: moments.sample_period_s(),
        sample_phase_s: moments.sample_phase_s(),
    };
    let period = timing.sample_period_s;
    let theta = fit.theta();
    let n = theta.len();
    let covariance = fit.covariance().as_ref().submatrix(0, 0, n, n).to_owned();
    let step_bounds = StepBounds::new(
        &responses.step_values,
        &responses.step,
        level,
        allowances.step,
    );
    let frequency_bounds = FrequencyBounds::new(
        &responses.frequency_values,
        &responses.frequency,
        level,
        allowances.frequency.clone(),
    );
    let omega_rad_s: Vec<f64> = responses.omegas.iter().map(|w| w / period).collect();
    let parameter_bounds = ParameterBounds {
        level,
        covariance: to_rows(&covariance),
    };
    let metrics = Metrics::new(&Measured {
        basis: *basis,
        theta: &theta,
        covariance,
        step: &responses.step_values,
        step_bounds: &step_bounds,
        omega_rad_s: &omega_rad_s,
        frequency_bounds: &frequency_bounds,
        timing,
    });
    let follows_motion = fitted.linearity.is_some_and(|found| found.is_rejected());
    Model {
        schema: MODEL_SCHEMA,
        sample_period_s: period,
        sample_phase_s: timing.sample_phase_s,
        structure: Structure {
            settling_samples: basis.settling(),
            frequencies: n,
            noise_order: fit.ar.len(),
            selected_by: plan.selected_by,
        },
        theta,
        bounds: Bounds::Valid(parameter_bounds),
        offset: fit.offset(information),
        noise: Noise {
            ar: fit.ar.clone(),
            sigma: fit.variance.sqrt(),
        },
        metrics,
        linear: fitted.misfit.is_none() && !follows_motion,
        step: StepResponse::new(
            period,
            responses.step_values.clone(),
            Bounds::Valid(step_bounds),
        ),
        frequency: FrequencyResponse::new(
            period,
            &responses.omegas,
            &responses.frequency_values,
            Bounds::Valid(frequency_bounds),
        ),
        fit: figures_of_merit(fitted),
        residuals: Residuals::default(),
        iterations: fit.iterations,
        converged: fit.converged,
        advice: Vec::new(),
    }
}

/// How the model came about.
pub(super) fn explanation(
    task: &Task<'_>,
    fitted: Fitted,
    responses: &Responses,
    allowances: &Allowances,
    model: &Model,
) -> Explanation {
    let (plan, estimate) = (fitted.candidate.plan, fitted.estimate);
    let information = &estimate.information;
    Explanation {
        settling: plan.choice,
        frequencies: plan.banks,
        noise_orders: estimate.fit.orders,
        path: information.path(),
        condition: estimate.fit.solution.condition,
        rows: information.rows(),
        degrees_of_freedom: responses.step.degrees_of_freedom.clone(),
        model_errors: fitted.misfit,
        linearity: fitted.linearity,
        at_rest: task
            .record
            .and_then(|record| contradicted_rest(record, model)),
        excitation: Some(Excitation {
            bounded: allowances.bounded,
            ..Excitation::of(&information.moments)
        }),
        resolution: allowances.quantisation,
        runs: task
            .record
            .and_then(|record| RunComparison::of(model, record.runs())),
    }
}
