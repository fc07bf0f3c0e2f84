//! How well a model fits what it was made from.

use super::Pipeline;
use super::estimate::Estimate;
use crate::diagnostics::linearity::Linearity;
use crate::diagnostics::residual_tests::{self, WHITENESS_SAMPLES};
use crate::diagnostics::simulation_error::beginnings;
use crate::results::model::{Fit, Model};
use crate::results::residuals::Residuals;
use crate::results::validation::fit_percent;

impl Pipeline<'_> {
    /// The figures of merit that follow from the moments.
    pub(super) fn figures_of_merit(&self, estimate: &Estimate) -> Fit {
        let Estimate {
            information, fit, ..
        } = estimate;
        let error = information.residual_moments(&fit.impulse(), fit.solution.offset(), 0);
        let spread = information.moments.output_spread();
        let error = error[(0, 0)].max(0.0);
        Fit {
            simulation_percent: fit_percent(error, spread),
            one_step_percent: fit_percent(fit.solution.rss, spread),
            rmse: (error / information.rows() as f64).sqrt(),
            samples_used: information.rows(),
            samples_missing: self.collected.moments.missing(),
        }
    }

    /// Residual tests; that of whiteness needs the samples.
    pub(super) fn residuals(
        &self,
        model: &Model,
        estimate: &Estimate,
        linearity: Option<Linearity>,
    ) -> Residuals {
        let Estimate {
            coordinates, fit, ..
        } = estimate;
        let rest = linearity.and_then(|found| found.rest);
        Residuals {
            input_correlation_p: residual_tests::input_independence(
                &self.collected.extended,
                coordinates,
                &fit.ar,
            ),
            whiteness_p: self.whiteness(model, estimate),
            linearity_p: linearity.map(|found| found.p),
            beyond_linear_percent: linearity.map(|found| found.misfit_percent),
            rest_p: rest.map(|found| found.p),
            beyond_rest_percent: rest.map(|found| found.misfit_percent),
        }
    }

    fn whiteness(&self, model: &Model, estimate: &Estimate) -> Option<f64> {
        let ar = &estimate.fit.ar;
        let errors: Vec<Vec<f64>> = beginnings(self.record?.runs(), WHITENESS_SAMPLES)
            .map(|run| one_step_errors(run.output(), &model.simulate(&run), ar))
            .collect();
        let parameters = (estimate.coordinates.len() + 1) as f64;
        let share = parameters / estimate.information.rows() as f64;
        residual_tests::whiteness(&errors, ar.len(), share)
    }
}

/// ε(k) = D(z) (y - y_sim)(k); NaN where a value or its history is missing.
fn one_step_errors(output: &[f64], simulated: &[f64], ar: &[f64]) -> Vec<f64> {
    let error: Vec<f64> = output.iter().zip(simulated).map(|(y, s)| y - s).collect();
    let order = ar.len();
    let mut filtered = vec![f64::NAN; error.len().min(order)];
    filtered.extend(error.windows(order + 1).map(|window| {
        let (past, now) = window.split_at(order);
        now[0] + past.iter().rev().zip(ar).map(|(v, d)| d * v).sum::<f64>()
    }));
    filtered
}
