//! Figures of the frequency response, freed of the hold and phase of the samples.

use std::f64::consts::{FRAC_PI_2, PI, SQRT_2};

use faer::Mat;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use super::draws::{interval_of, pairs, semidefinite_factor};
use super::{Interval, Measured};
use crate::basis::dot;
use crate::curve::CurveSpread;
use crate::frequency::{FrequencyResponse, ZERO_DB};

/// Points at which a crossing is looked for, evenly over the logarithm of frequency.
const SCAN: usize = 200;

/// Half width of the parabola around a crossing, in standard deviations of the crossing: draws
/// seldom go beyond.
const REACH: f64 = 4.0;

/// Smallest and largest half width relative to the frequency: the parabola needs a base, and
/// beyond the largest it no longer describes the response.
const BASE: (f64, f64) = (0.01, 0.3);

/// A frequency at which something is reached, and its draws \[rad/s\].
pub(crate) struct Crossing {
    pub(crate) value: f64,
    pub(crate) draws: Vec<f64>,
}

impl Crossing {
    pub(crate) fn interval(&self, level: f64) -> Interval {
        interval_of(self.value, &mut self.draws.clone(), level)
    }
}

/// Where the magnitude is 3 dB (half the power) below that at rest.
pub(crate) fn bandwidth(measured: &Measured<'_>, widest: f64, random: &mut ChaCha8Rng) -> Crossing {
    let timing = measured.timing;
    crossing(
        measured,
        widest,
        random,
        &move |omega, (re, im), gain, _| {
            (re.hypot(im) * timing.magnitude_factor(omega) * SQRT_2 / gain.abs()).ln()
        },
    )
}

/// Where the phase is -90 degrees.
pub(crate) fn quarter_turn(
    measured: &Measured<'_>,
    widest: f64,
    random: &mut ChaCha8Rng,
) -> Crossing {
    let timing = measured.timing;
    crossing(
        measured,
        widest,
        random,
        &move |omega, (re, im), gain, near| {
            let (re, im) = (re * gain.signum(), im * gain.signum());
            let phase = im.atan2(re) + timing.phase_lead(omega) + FRAC_PI_2;
            // The branch next to the phase one is near to.
            phase - 2.0 * PI * ((phase - near) / (2.0 * PI)).round()
        },
    )
}

/// (ω, G, gain, value nearby) to what crosses zero downwards.
type Indicator<'a> = &'a dyn Fn(f64, (f64, f64), f64, f64) -> f64;

fn crossing(
    measured: &Measured<'_>,
    widest: f64,
    random: &mut ChaCha8Rng,
    indicator: Indicator<'_>,
) -> Crossing {
    let none = Crossing {
        value: f64::INFINITY,
        draws: Vec::new(),
    };
    let period = measured.timing.sample_period_s;
    let gain = measured.theta[0];
    let at = |omega: f64, near: f64| {
        let response = measured
            .basis
            .frequency_response(measured.theta, omega * period);
        indicator(omega, response, gain, near)
    };
    let Some(omega) = first_zero(measured, &at) else {
        return none;
    };
    // Slope and standard deviation at the crossing give the base of the parabola.
    let h = 1e-3 * omega;
    let slope = (at(omega + h, 0.0) - at(omega - h, 0.0)) / (2.0 * h);
    let rows = Rows::new(measured, &[omega]);
    let sd = widest * rows.sd_of(|(g, gain)| indicator(omega, g[0], gain, 0.0));
    let (smallest, largest) = BASE;
    let half = (REACH * sd / slope.abs()).clamp(smallest * omega, largest * omega);
    let omegas = [omega - half, omega, omega + half];
    let rows = Rows::new(measured, &omegas);
    let factor = semidefinite_factor(&rows.covariance);
    let size = factor.nrows();
    let count = pairs(measured.step.pointwise.level);
    let mut draws = Vec::with_capacity(2 * count);
    let nominal = [at(omegas[0], 0.0), at(omega, 0.0), at(omegas[2], 0.0)];
    for _ in 0..count {
        let z: Vec<f64> = (0..size).map(|_| StandardNormal.sample(random)).collect();
        let deviation = crate::linear::times(&factor, &z);
        for side in [widest, -widest] {
            let (g, gain) = rows.moved(&deviation, side);
            let f: [f64; 3] = std::array::from_fn(|k| indicator(omegas[k], g[k], gain, nominal[k]));
            draws.push(omega + half * parabola_zero(f));
        }
    }
    Crossing {
        value: omega,
        draws,
    }
}

/// The lowest frequency, from the lowest of interest to the highest of the bank, where `at` has
/// come down to zero.
fn first_zero(measured: &Measured<'_>, at: &dyn Fn(f64, f64) -> f64) -> Option<f64> {
    let basis = measured.basis;
    let period = measured.timing.sample_period_s;
    let low = 0.02 * basis.fundamental() / period;
    let high = basis.highest().max(1) as f64 * basis.fundamental() / period;
    let ratio = (high / low).ln() / (SCAN - 1) as f64;
    let mut before = (low, at(low, FRAC_PI_2));
    for k in 1..SCAN {
        let omega = low * (ratio * k as f64).exp();
        let value = at(omega, before.1);
        if before.1 > 0.0 && value <= 0.0 {
            let (mut inside, mut outside) = (before.0, omega);
            for _ in 0..50 {
                let middle = f64::midpoint(inside, outside);
                if at(middle, 0.0) > 0.0 {
                    inside = middle;
                } else {
                    outside = middle;
                }
            }
            return Some(outside);
        }
        before = (omega, value);
    }
    None
}

/// Zero of the parabola through (-1, f0), (0, f1), (1, f2), the one nearest to 0; infinite when
/// there is none within twice the base.
fn parabola_zero([before, here, after]: [f64; 3]) -> f64 {
    let (slope, bend) = ((after - before) / 2.0, (after + before) / 2.0 - here);
    let root = slope * slope - 4.0 * bend * here;
    if root < 0.0 {
        return f64::INFINITY;
    }
    let x = -2.0 * here / (slope + slope.signum() * root.sqrt());
    if x.abs() <= 2.0 { x } else { f64::INFINITY }
}

/// Re G, Im G at some frequencies and the gain, with their covariance.
struct Rows {
    value: Vec<f64>,
    covariance: Mat<f64>,
}

impl Rows {
    fn new(measured: &Measured<'_>, omegas: &[f64]) -> Self {
        let period = measured.timing.sample_period_s;
        let n = measured.theta.len();
        let mut rows: Vec<Vec<f64>> = Vec::new();
        for omega in omegas {
            let (re, im) = measured.basis.frequency_rows(omega * period);
            rows.extend([re, im]);
        }
        rows.push((0..n).map(|k| f64::from(u8::from(k == 0))).collect());
        let map = Mat::from_fn(n, rows.len(), |k, i| rows[i][k]);
        Self {
            value: rows.iter().map(|row| dot(row, measured.theta)).collect(),
            covariance: map.transpose() * (measured.covariance * &map),
        }
    }

    /// Values moved by `side` times `deviation`.
    fn moved(&self, deviation: &[f64], side: f64) -> (Vec<(f64, f64)>, f64) {
        let at = |k: usize| self.value[k] + side * deviation[k];
        let last = self.value.len() - 1;
        let pairs = (0..last / 2).map(|k| (at(2 * k), at(2 * k + 1))).collect();
        (pairs, at(last))
    }

    /// Standard deviation of a function of the values, by its differences.
    fn sd_of(&self, function: impl Fn((Vec<(f64, f64)>, f64)) -> f64) -> f64 {
        let size = self.value.len();
        let gradient: Vec<f64> = (0..size)
            .map(|k| {
                let sd = self.covariance[(k, k)].max(0.0).sqrt();
                let unit: Vec<f64> = (0..size).map(|j| f64::from(u8::from(j == k))).collect();
                let h = 1e-3 * sd;
                if h == 0.0 {
                    return 0.0;
                }
                (function(self.moved(&unit, h)) - function(self.moved(&unit, -h))) / (2.0 * h)
            })
            .collect();
        dot(
            &gradient,
            &crate::linear::times(&self.covariance, &gradient),
        )
        .max(0.0)
        .sqrt()
    }
}

/// The response of the servo with its bounds.
pub(crate) fn servo_response(measured: &Measured<'_>, omega_rad_s: &[f64]) -> FrequencyResponse {
    let timing = measured.timing;
    let rows = Rows::new(measured, omega_rad_s);
    let count = 2 * omega_rad_s.len();
    let sd: Vec<f64> = (0..count)
        .map(|k| rows.covariance[(k, k)].max(0.0).sqrt())
        .collect();
    let correlation = |k: usize| {
        let scale = sd[k] * sd[k + 1];
        if scale > 0.0 {
            (rows.covariance[(k, k + 1)] / scale).clamp(-1.0, 1.0)
        } else {
            1.0
        }
    };
    let spread = CurveSpread {
        neighbour_correlation: (0..count.saturating_sub(1)).map(correlation).collect(),
        degrees_of_freedom: vec![f64::INFINITY; count],
        sd,
    };
    let omegas: Vec<f64> = omega_rad_s
        .iter()
        .map(|omega| omega * timing.sample_period_s)
        .collect();
    let level = measured.step.pointwise.level;
    let mut response = FrequencyResponse::new(
        timing.sample_period_s,
        &omegas,
        &rows.value[..count],
        &spread,
        level,
    );
    for (k, &omega) in omega_rad_s.iter().enumerate() {
        let (factor, lead) = (timing.magnitude_factor(omega), timing.phase_lead(omega));
        let (sin, cos) = lead.sin_cos();
        let (re, im) = (response.re[k], response.im[k]);
        response.re[k] = factor * (re * cos - im * sin);
        response.im[k] = factor * (re * sin + im * cos);
        let decibels = 20.0 * factor.log10();
        for magnitude in [
            &mut response.magnitude_db[k],
            &mut response.magnitude_db_lower[k],
            &mut response.magnitude_db_upper[k],
        ] {
            if *magnitude > ZERO_DB {
                *magnitude += decibels;
            }
        }
        for phase in [
            &mut response.phase_deg[k],
            &mut response.phase_deg_lower[k],
            &mut response.phase_deg_upper[k],
        ] {
            *phase += lead.to_degrees();
        }
    }
    response
}

/// The phase of the servo at one frequency \[degrees\], continued from rest.
pub(crate) fn phase_at(measured: &Measured<'_>, omega: f64) -> Interval {
    // Steps of at most a quarter of the fundamental: between them no response of N samples turns
    // by half a turn.
    let step = 0.25 * measured.basis.fundamental() / measured.timing.sample_period_s;
    let steps = (omega / step).ceil().max(1.0);
    let path: Vec<f64> = (1..=steps as usize)
        .map(|k| omega * k as f64 / steps)
        .collect();
    let gain = measured.theta[0].signum();
    let mut phase = if gain < 0.0 { -PI } else { 0.0 };
    for omega in &path {
        let (re, im) = measured
            .basis
            .frequency_response(measured.theta, omega * measured.timing.sample_period_s);
        let next = im.atan2(re) + measured.timing.phase_lead(*omega);
        phase = next - 2.0 * PI * ((next - phase) / (2.0 * PI)).round();
    }
    let bounds = servo_response(measured, &[omega]);
    let turn = phase.to_degrees() - bounds.phase_deg[0];
    let (lower, upper) = (
        bounds.phase_deg_lower[0] + turn,
        bounds.phase_deg_upper[0] + turn,
    );
    if upper - lower >= 359.999 {
        return Interval::new(phase.to_degrees(), f64::INFINITY, f64::INFINITY);
    }
    Interval::new(phase.to_degrees(), lower, upper)
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_abs_diff_eq;

    #[test]
    fn the_nearest_zero_of_a_parabola_is_found_whether_bent_or_straight() {
        let f = |zero: f64, other: f64, x: f64| (x - zero) * (x - other);
        let at = |zero, other| {
            [
                f(zero, other, -1.0),
                f(zero, other, 0.0),
                f(zero, other, 1.0),
            ]
        };
        assert_abs_diff_eq!(parabola_zero(at(0.3, 7.0)), 0.3, epsilon = 1e-12);
        assert_abs_diff_eq!(parabola_zero(at(-0.2, -9.0)), -0.2, epsilon = 1e-12);
        assert_abs_diff_eq!(parabola_zero([1.5, 0.5, -0.5]), 0.5, epsilon = 1e-12);
        assert_eq!(parabola_zero([1.0, 0.5, 1.0]), f64::INFINITY);
    }
}
