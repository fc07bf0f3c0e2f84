//! How well a model fits the data that it was made from.

use super::estimate::Estimate;
use super::fitted::Fitted;
use super::task::Task;
use crate::diagnostics::{
    WHITENESS_SAMPLES, beginnings, input_independence, one_step_errors, whiteness,
};
use crate::results::{Fit, Model, Residuals, fit_percent};

/// The figures of merit that follow from the moments, to which samples that were taken out are missing.
pub(super) fn figures_of_merit(fitted: &Fitted, taken_out: usize) -> Fit {
    let estimate = &fitted.estimate;
    let information = &estimate.information;
    let rmse = estimate.rmse();
    let error = rmse.powi(2) * information.rows() as f64;
    let spread = information.moments.output_spread();
    Fit {
        simulation_percent: fit_percent(error, spread),
        one_step_percent: fit_percent(estimate.fit.solution.rss, spread),
        rmse,
        samples_used: information.rows(),
        samples_missing: fitted.candidate.moments.missing().saturating_sub(taken_out),
    }
}

/// Residual tests; that of whiteness needs the samples.
pub(super) fn residuals(task: &Task<'_>, fitted: &Fitted, model: &Model) -> Residuals {
    let (estimate, linearity) = (&fitted.estimate, fitted.linearity);
    let rest = linearity.and_then(|found| found.rest);
    Residuals {
        input_correlation_p: input_independence(
            &fitted.candidate.extended,
            &estimate.coordinates,
            &estimate.fit.ar,
        ),
        whiteness_p: whiteness_p(task, estimate, model),
        linearity_p: linearity.map(|found| found.p),
        beyond_linear_percent: linearity.map(|found| found.misfit_percent),
        rest_p: rest.map(|found| found.p),
        beyond_rest_percent: rest.map(|found| found.misfit_percent),
    }
}

fn whiteness_p(task: &Task<'_>, estimate: &Estimate, model: &Model) -> Option<f64> {
    let ar = &estimate.fit.ar;
    let errors: Vec<Vec<f64>> = beginnings(task.record?.runs(), WHITENESS_SAMPLES)
        .map(|run| {
            let simulated = model.simulate(&run);
            let errors: Vec<f64> = run
                .output()
                .iter()
                .zip(&simulated)
                .map(|(y, s)| y - s)
                .collect();
            one_step_errors(&errors, ar)
        })
        .collect();
    let parameters = (estimate.coordinates.len() + 1) as f64;
    let share = parameters / estimate.information.rows() as f64;
    whiteness(&errors, ar.len(), share)
}
