//! The response of the servo itself: that of the samples, freed of their hold and phase.

use std::f64::consts::PI;

use faer::Mat;
use serde::{Deserialize, Serialize};

use crate::data::Timing;
use crate::error::Error;
use crate::estimation::{CurveVariance, FsfBasis};
use crate::results::frequency_response::{FrequencyBounds, FrequencyResponse};
use crate::results::metrics::bands;
use crate::results::metrics::interval::Interval;
use crate::results::metrics::measured::Measured;
use crate::results::model::Model;

/// The phase of the servo at one frequency.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct PhaseAt {
    /// Frequency \[rad/s\].
    pub omega_rad_s: f64,
    /// Phase \[degrees\]; a lag is negative.
    pub phase_deg: Interval,
}

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
        sd,
    };
    let bias = bands::bias(measured, omega_rad_s);
    FrequencyBounds::new(values, &spread, measured.level(), bias)
}

/// The phase at one frequency \[rad\], followed from rest.
fn continued_phase(basis: &FsfBasis, theta: &[f64], timing: Timing, omega: f64) -> f64 {
    // Steps of at most a quarter of the fundamental: between them no response of N samples turns
    // by half a turn.
    let step = 0.25 * basis.fundamental() / timing.sample_period_s;
    let steps = (omega / step).ceil().max(1.0);
    let start = if theta[0] < 0.0 { -PI } else { 0.0 };
    (1..=steps as usize).fold(start, |phase, k| {
        let omega = omega * k as f64 / steps;
        let (re, im) = basis.frequency_response(theta, omega * timing.sample_period_s);
        let next = im.atan2(re) + timing.phase_lead(omega);
        next - 2.0 * PI * ((next - phase) / (2.0 * PI)).round()
    })
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

    /// The phase of the servo at given frequencies \[rad/s\], continued from zero at rest. A
    /// frequency at which any phase is possible has no bounds.
    ///
    /// ```
    /// # use servoid_identification::{identify, Options, Record, Settling};
    /// # let u: Vec<f64> = (0..400).map(|k| f64::from(k * k / 35 % 2)).collect();
    /// # let y: Vec<f64> = (0..400).map(|k| u[k.max(2) - 2] + 0.001 * f64::from(k as u32 * 7919 % 101)).collect();
    /// # let options = Options { settling: Settling::Samples(31), ..Options::default() };
    /// // A servo that answers two samples late, 10 ms apart and held: its phase is -ω (20 - 5) ms.
    /// let model = identify(&Record::from_slices(0.01, &u, &y)?, &options)?;
    /// let phase = model.phase_at(&[10.0])?[0].phase_deg;
    /// assert!((phase.value.unwrap() + 0.15f64.to_degrees()).abs() < 1.0);
    /// # Ok::<(), servoid_identification::Error>(())
    /// ```
    ///
    /// # Errors
    /// The structure of a hand-made document does not describe a filter bank.
    pub fn phase_at(&self, omega_rad_s: &[f64]) -> Result<Vec<PhaseAt>, Error> {
        let (basis, response) = (self.basis()?, self.servo_response(omega_rad_s)?);
        let of = |(k, &omega_rad_s): (usize, &f64)| {
            let phase =
                continued_phase(&basis, &self.theta, self.timing(), omega_rad_s).to_degrees();
            let turn = phase - response.phase_deg[k];
            let known = response.bounds.valid().map(|bounds| {
                let (lower, upper) = (bounds.phase_deg_lower[k], bounds.phase_deg_upper[k]);
                (lower + turn, upper + turn)
            });
            let (lower, upper) = known
                .filter(|(lower, upper)| upper - lower < 359.999)
                .unwrap_or((f64::NAN, f64::NAN));
            PhaseAt {
                omega_rad_s,
                phase_deg: Interval::new(phase, lower, upper),
            }
        };
        Ok(omega_rad_s.iter().enumerate().map(of).collect())
    }
}
