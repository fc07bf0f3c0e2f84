//! The response of the servo itself: that of the samples, freed of their hold and phase.

use std::cell::LazyCell;
use std::f64::consts::FRAC_1_SQRT_2;

use faer::Mat;

use crate::error::Error;
use crate::estimation::CurveVariance;
use crate::numerics::not_negative;
use crate::results::frequency_response::{FrequencyBounds, FrequencyResponse};
use crate::results::metrics::frequency_metrics;
use crate::results::metrics::in_band::folding;
use crate::results::metrics::measured::Measured;
use crate::results::metrics::sample_uncertainty::SampleSpread;
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
    // In documents without their own, those of the step response, the widest of all.
    let widest = LazyCell::new(|| SampleSpread::new(measured).widest());
    let known = measured.frequency_bounds;
    let widening = omega_rad_s.iter().map(|omega| {
        let own = known.widening_at(measured.omega_rad_s, *omega);
        own.unwrap_or_else(|| *widest)
    });
    let sd: Vec<f64> = widening
        .flat_map(|times| [times; 2])
        .enumerate()
        .map(|(k, times)| times * not_negative(covariance[(k, k)]).sqrt())
        .collect();
    let correlation = |k: usize| match sd[k] * sd[k + 1] {
        scale if scale > 0.0 => {
            let variances = covariance[(k, k)] * covariance[(k + 1, k + 1)];
            (covariance[(k, k + 1)] / variances.sqrt()).clamp(-1.0, 1.0)
        }
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
    /// the samples, and this is freed of their hold and phase (see [`Timing`](crate::Timing)). Where bounds hold [in a band](Model::band) alone, it has
    /// them at the frequencies of the model's own response.
    ///
    /// # Errors
    /// The structure of a hand-made document does not describe a filter bank.
    pub fn servo_response(&self, omega_rad_s: &[f64]) -> Result<FrequencyResponse, Error> {
        if self.band().is_some() && omega_rad_s == self.frequency.omega_rad_s {
            return Ok(self.response_in_band());
        }
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

    /// The response of the servo in the band that the input excites. What is folded into it is that of a lag with the gain and bandwidth seen there; without a
    /// bandwidth nothing says how much that is.
    fn response_in_band(&self) -> FrequencyResponse {
        let (found, timing) = (&self.frequency, self.timing());
        let magnitudes = found.re.iter().zip(&found.im).map(|(re, im)| re.hypot(*im));
        let of_servo = (found.omega_rad_s.iter().zip(magnitudes))
            .map(|(omega, magnitude)| (*omega, magnitude * timing.magnitude_factor(*omega)));
        let of_servo: Vec<(f64, f64)> = of_servo.collect();
        let seen = of_servo.first().map_or(0.0, |(_, magnitude)| *magnitude);
        let fallen = of_servo
            .iter()
            .find(|(_, magnitude)| *magnitude < seen * FRAC_1_SQRT_2);
        let r = fallen.map_or(0.0, |(bandwidth, _)| seen * bandwidth);
        let folded = |omega: &f64| folding(*omega, r, timing);
        let folded: Vec<f64> = found.omega_rad_s.iter().map(folded).collect();
        let bounds = found.bounds.clone().map(|bounds| bounds.with_bias(&folded));
        FrequencyResponse {
            bounds,
            ..found.clone()
        }
        .freed_of_hold(timing)
    }
}
