//! Values and spreads of the step and frequency responses.

use super::estimate::Estimate;
use crate::estimation::CurveVariance;
use crate::numerics::times;
use crate::results::{frequency_grid, frequency_map};

pub(super) struct Responses {
    pub(super) step_values: Vec<f64>,
    pub(super) step: CurveVariance,
    /// Frequencies \[rad/sample\].
    pub(super) omegas: Vec<f64>,
    /// Real and imaginary parts in turn.
    pub(super) frequency_values: Vec<f64>,
    pub(super) frequency: CurveVariance,
}

impl Responses {
    pub(super) fn new(estimate: &Estimate) -> Self {
        let Estimate {
            coordinates,
            information,
            fit,
        } = estimate;
        let omegas = frequency_grid(coordinates);
        let map = frequency_map(coordinates, &omegas);
        Self {
            step_values: coordinates.basis.step_response(&fit.theta()),
            step: CurveVariance::of_fit(information, fit, &coordinates.step_map()),
            frequency: CurveVariance::of_fit(information, fit, &map),
            frequency_values: times(&map, fit.solution.response()),
            omegas,
        }
    }

    /// Whether all standard deviations are numbers.
    pub(super) fn have_variances(&self) -> bool {
        let all = self.step.sd.iter().chain(&self.frequency.sd);
        all.copied().all(f64::is_finite)
    }
}
