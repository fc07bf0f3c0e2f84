//! The response of the servo itself: that of the samples, freed of their hold and phase.

use faer::Mat;

use crate::error::Error;
use crate::estimation::CurveVariance;
use crate::results::frequency_response::{FrequencyBounds, FrequencyResponse};
use crate::results::metrics::frequency_metrics;
use crate::results::metrics::measured::Measured;
use crate::results::model::Model;

/// Bounds of `values`, Re G and Im G in turn at some frequencies \[rad/s\].
fn bounds_of(measured: &Measured<'_>, omega_rad_s: &[f64], values: &[f64]) -> FrequencyBounds {
    let period = measured.timing.sample_period_s;
    let rows: Vec<Vec<f64>> = omega_rad_s
        .iter()
        .flat_map(|omega| <[_; 2]>::from(measured.basis.frequency_rows(omega * period)))
        .collect();
    let map = Mat::from_fn(measured.theta.len(), rows.len(), |k, i| rows[i][k]);
    let covariance = map.transpose() * (&measured.covariance * &map);
    let sd: Vec<f64> = (0..rows.len())
        .map(|k| covariance[(k, k)].max(0.0).sqrt())
        .collect();
    let correlation = |k: usize| match sd[k] * sd[k + 1] {
        scale if scale > 0.0 => (covariance[(k, k + 1)] / scale).clamp(-1.0, 1.0),
        _ => 1.0,
    };
    let spread = CurveVariance {
        neighbour_correlation: (0..rows.len().saturating_sub(1)).map(correlation).collect(),
        degrees_of_freedom: vec![f64::INFINITY; rows.len()],
        of_runs: None,
        sd,
    };
    let bias = frequency_metrics::bias(measured, omega_rad_s);
    FrequencyBounds::new(values, &spread, measured.level(), bias)
        .with_delay_error(omega_rad_s, measured.frequency_bounds.delay_error_s)
}

impl Model {
    /// The frequency response of the servo itself, at any frequencies \[rad/s\] up to half the rate
    /// of sampling, with pointwise bounds at the level of the model: [`Model::frequency`] is that of
    /// the samples, and this is freed of their hold and phase (see [`Timing`](crate::Timing)).
    ///
    /// # Errors
    /// The structure of a hand-made document does not describe a filter bank.
    pub fn servo_response(&self, omega_rad_s: &[f64]) -> Result<FrequencyResponse, Error> {
        let (basis, timing) = (self.basis()?, self.timing());
        let omegas: Vec<f64> = omega_rad_s
            .iter()
            .map(|omega| omega * timing.sample_period_s)
            .collect();
        let values: Vec<f64> = omegas
            .iter()
            .map(|&omega| basis.frequency_response(&self.theta, omega))
            .flat_map(<[_; 2]>::from)
            .collect();
        let known = self.measured()?;
        let bounds = known.map(|known| bounds_of(&known, omega_rad_s, &values));
        let of_samples = FrequencyResponse::new(timing.sample_period_s, &omegas, &values, bounds);
        Ok(of_samples.freed_of_hold(timing))
    }
}
