//! A response and its uncertainty: all that metrics are read from.

use faer::Mat;

use crate::data::Timing;
use crate::estimation::FsfBasis;
use crate::results::frequency_response::FrequencyBounds;
use crate::results::step_response::StepBounds;

/// A response with bounds that hold.
pub(crate) struct Measured<'a> {
    pub(crate) basis: FsfBasis,
    pub(crate) theta: &'a [f64],
    /// Covariance of θ.
    pub(crate) covariance: Mat<f64>,
    /// The step response.
    pub(crate) step: &'a [f64],
    pub(crate) step_bounds: &'a StepBounds,
    /// Frequencies at which the frequency response is known \[rad/s\].
    pub(crate) omega_rad_s: &'a [f64],
    pub(crate) frequency_bounds: &'a FrequencyBounds,
    pub(crate) timing: Timing,
}

impl Measured<'_> {
    /// Confidence level.
    pub(crate) fn level(&self) -> f64 {
        self.step_bounds.level
    }

    /// Bound of the error of G from left-out frequencies and the steps of the sensor, at `omega` \[rad/s\].
    pub(crate) fn bias_at(&self, omega: f64) -> f64 {
        self.frequency_bounds.bias_at(self.omega_rad_s, omega)
    }
}
