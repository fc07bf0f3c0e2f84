//! Gain, bandwidth and the frequency of -90 degrees from the response at a row of frequencies, where no step response is known.
//!
//! As elsewhere a frequency has the interval at which a function that is linear in the response is not surely on one side of zero (Fieller 1954). Between points
//! the functions and their bounds are taken to be straight.

use std::f64::consts::SQRT_2;

use super::interval::Interval;
use super::{MetricBounds, Metrics, Withheld};
use crate::data::Timing;
use crate::numerics::not_negative;
use crate::results::Bounds;

/// The response of the samples at one frequency.
#[derive(Debug, Clone, Copy)]
pub(crate) struct BandPoint {
    /// \[rad/s\]
    pub(crate) omega_rad_s: f64,
    /// Re G and Im G.
    pub(crate) value: (f64, f64),
    /// Their standard deviations.
    pub(crate) sd: (f64, f64),
    /// Their correlation.
    pub(crate) correlation: f64,
    /// Their covariances with the response at rest.
    pub(crate) with_rest: (f64, f64),
    /// Standard deviations of a bound to each side.
    pub(crate) critical: f64,
}

/// A function that comes down to zero, with its bounds, at one frequency.
#[derive(Debug, Clone, Copy)]
struct Falling {
    omega: f64,
    value: f64,
    lower: f64,
    upper: f64,
}

impl Metrics {
    /// Of the response at `rest` and at `points` of ascending frequency. All but the three are left out; gain and bandwidth, too, where the response at rest is
    /// not known. The sign of the gain is then that of the response at the lowest frequency, where that is within an eighth of a turn of it.
    pub(crate) fn in_band(
        rest: &BandPoint,
        points: &[BandPoint],
        rest_is_known: bool,
        timing: Timing,
        bounds: Bounds<MetricBounds>,
    ) -> Self {
        let none = Self::withheld(Interval::default(), Withheld::InputUnexcited, bounds);
        let Some(lowest) = points.first().filter(|point| is_in_phase(point)) else {
            return none;
        };
        let fallen = |from: f64| crossing(points, |point| fallen_by_half(point, from, timing));
        // What is folded is that of a lag with this gain and bandwidth; without a bandwidth nothing says how much it is.
        let seen = lowest.value.0.hypot(lowest.value.1);
        let Some(r) = fallen(seen).value.map(|bandwidth| seen * bandwidth) else {
            return none;
        };
        let sign = lowest.value.0.signum();
        let quarter = crossing(points, |point| turned_by_quarter(point, sign, timing, r));
        let with_quarter = Self {
            phase_minus_90_rad_s: quarter,
            ..none
        };
        if !rest_is_known {
            return with_quarter;
        }
        let gain = rest.value.0;
        let half = rest.critical * rest.sd.0;
        Self {
            dc_gain: Interval::new(gain, gain - half, gain + half),
            bandwidth_rad_s: crossing(points, |point| below_rest(point, rest, timing, r)),
            ..with_quarter
        }
    }
}

/// Whether the phase of the response is within an eighth of a turn of 0, or of a half turn.
fn is_in_phase(point: &BandPoint) -> bool {
    point.value.1.abs() < point.value.0.abs()
}

/// What is folded onto the response of the samples from beyond half their rate, of a response that falls as that of a lag, r/ω (see [`super::aliasing`]).
pub(crate) fn folding(omega: f64, r: f64, timing: Timing) -> f64 {
    let factor = timing.magnitude_factor(omega);
    r / omega * (factor - 1.0 / factor)
}

/// By how much √2 |G| of the servo is above `from`, without bounds.
fn fallen_by_half(point: &BandPoint, from: f64, timing: Timing) -> Falling {
    let factor = SQRT_2 * timing.magnitude_factor(point.omega_rad_s);
    let value = factor * point.value.0.hypot(point.value.1) - from;
    Falling::new(point, value, 0.0, 0.0)
}

/// By how much √2 |G| of the servo is above the gain.
fn below_rest(point: &BandPoint, rest: &BandPoint, timing: Timing, r: f64) -> Falling {
    let (re, im) = point.value;
    let magnitude = re.hypot(im);
    let factor = SQRT_2 * timing.magnitude_factor(point.omega_rad_s);
    let (a, b) = (factor * re / magnitude, factor * im / magnitude);
    let sign = rest.value.0.signum();
    let with_rest = a * point.with_rest.0 + b * point.with_rest.1;
    let variance = variance(point, (a, b)) + rest.sd.0.powi(2) - 2.0 * sign * with_rest;
    let bias = factor * folding(point.omega_rad_s, r, timing);
    let value = factor * magnitude - rest.value.0.abs();
    let critical = point.critical.max(rest.critical);
    Falling::new(&BandPoint { critical, ..*point }, value, variance, bias)
}

/// The part of the response that has the phase of a gain of this sign.
fn turned_by_quarter(point: &BandPoint, sign: f64, timing: Timing, r: f64) -> Falling {
    let (sin, cos) = timing.phase_lead(point.omega_rad_s).sin_cos();
    let (a, b) = (sign * cos, -sign * sin);
    let value = a * point.value.0 + b * point.value.1;
    let bias = folding(point.omega_rad_s, r, timing);
    Falling::new(point, value, variance(point, (a, b)), bias)
}

fn variance(point: &BandPoint, (a, b): (f64, f64)) -> f64 {
    let (re, im) = (a * point.sd.0, b * point.sd.1);
    re * re + im * im + 2.0 * point.correlation * re * im
}

impl Falling {
    fn new(point: &BandPoint, value: f64, variance: f64, bias: f64) -> Self {
        let half = point.critical * not_negative(variance).sqrt() + bias;
        Self {
            omega: point.omega_rad_s,
            value,
            lower: value - half,
            upper: value + half,
        }
    }
}

/// Where a function first comes down to zero; no value where it does not, and no bound where it does not surely.
fn crossing(points: &[BandPoint], function: impl Fn(&BandPoint) -> Falling) -> Interval {
    let all: Vec<Falling> = points.iter().map(function).collect();
    let first = |of: fn(&Falling) -> f64| {
        let place = all.windows(2).find_map(|pair| {
            let (before, after) = (of(&pair[0]), of(&pair[1]));
            let share = before / (before - after);
            (before > 0.0 && after <= 0.0)
                .then(|| pair[0].omega + share * (pair[1].omega - pair[0].omega))
        });
        place.unwrap_or(f64::INFINITY)
    };
    let lower = match all.first() {
        Some(point) if point.lower > 0.0 => first(|point| point.lower),
        _ => f64::INFINITY,
    };
    Interval::new(
        first(|point| point.value),
        lower,
        first(|point| point.upper),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A lag of 20 ms and 10 ms of dead time, both exact: -3 dB at 50 rad/s, -90 degrees where 0.01 ω + atan(0.02 ω) is a quarter turn.
    #[test]
    fn frequencies_of_a_known_response_are_found() {
        let timing = Timing {
            sample_period_s: 1e-4,
            sample_phase_s: 5e-5,
        };
        let point = |omega: f64| {
            let phase = -(0.01 * omega + (0.02 * omega).atan());
            let magnitude =
                (1.0 + (0.02 * omega).powi(2)).sqrt().recip() / timing.magnitude_factor(omega);
            BandPoint {
                omega_rad_s: omega,
                value: (magnitude * phase.cos(), magnitude * phase.sin()),
                sd: (1e-3, 1e-3),
                correlation: 0.0,
                with_rest: (0.0, 0.0),
                critical: 2.576,
            }
        };
        let points: Vec<BandPoint> = (1..2000).map(|k| point(0.1 * f64::from(k))).collect();
        let level = Bounds::Valid(MetricBounds { level: 0.99 });
        let found = Metrics::in_band(&point(0.0), &points, true, timing, level);
        let bandwidth = found.bandwidth_rad_s;
        assert!(
            (bandwidth.value.unwrap() - 50.0).abs() < 1e-3,
            "{bandwidth:?}"
        );
        // The slope of √2 |G| there is 1/100, and its standard deviation √3 times that of a part.
        let half = 2.576e-3 * 3f64.sqrt() * 100.0;
        assert!(
            (bandwidth.upper.unwrap() - 50.0 - half).abs() < 0.05,
            "{bandwidth:?}"
        );
        let quarter = found.phase_minus_90_rad_s.value.unwrap();
        let phase = 0.01 * quarter + (0.02 * quarter).atan();
        assert!((phase - std::f64::consts::FRAC_PI_2).abs() < 1e-5);
        assert_eq!(found.delay_s, Interval::default());
        assert_eq!(found.withheld, Some(Withheld::InputUnexcited));
        let unknown = Metrics::in_band(&point(0.0), &points, false, timing, level);
        assert_eq!(
            (unknown.dc_gain, unknown.bandwidth_rad_s),
            (Interval::default(), Interval::default())
        );
        assert_eq!(unknown.phase_minus_90_rad_s, found.phase_minus_90_rad_s);
    }
}
