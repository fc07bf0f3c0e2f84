//! Metrics of the frequency response, freed of the hold and phase of the samples.
//!
//! Each is a frequency at which a function of the response comes down to zero, and has the interval of
//! the frequencies at which that function is not surely on one side of zero (Fieller 1954).

use std::f64::consts::{FRAC_PI_2, PI, SQRT_2};

use super::aliasing::Folding;
use super::interval::Interval;
use super::measured::Measured;
use crate::numerics::{dot, not_negative, pointwise_critical, times};

/// Points at which a crossing is looked for, evenly over the logarithm of frequency.
const SCAN: usize = 200;

/// Bounds are looked for in steps of this many times the distance at which the slope at the crossing
/// puts them, each twice as far as the one before.
const FIRST_STEP: f64 = 1.25;

/// Steps after which a bound counts as not there.
const STEPS: usize = 12;

/// Where the magnitude is 3 dB (half the power) below that at rest, and where the phase is -90
/// degrees \[rad/s\]. Deviations count `widest` times.
pub(crate) fn bandwidth_and_quarter_turn(measured: &Measured<'_>, widest: f64) -> [Interval; 2] {
    let scan = Scan::new(measured);
    let zeros = [FrequencyMetric::Bandwidth, FrequencyMetric::QuarterTurn]
        .map(|quantity| (quantity, quantity.first_zero(measured, &scan)));
    let folding = Folding::new(measured, zeros[0].1);
    zeros.map(|(quantity, zero)| {
        Falling {
            measured,
            quantity,
            folding: &folding,
            critical: widest * pointwise_critical(measured.level()),
        }
        .interval(zero)
    })
}

/// The response from the lowest frequency of interest to the highest of the bank.
struct Scan {
    omegas: Vec<f64>,
    responses: Vec<(f64, f64)>,
}

impl Scan {
    fn new(measured: &Measured<'_>) -> Self {
        let (basis, period) = (&measured.basis, measured.timing.sample_period_s);
        let low = 0.02 * basis.fundamental() / period;
        // A bank of the gain alone has no other frequency to look at.
        let points = if basis.highest() == 0 { 0 } else { SCAN };
        let high = basis.highest() as f64 * basis.fundamental() / period;
        let ratio = (high / low).ln() / (SCAN - 1) as f64;
        let omegas: Vec<f64> = (0..points)
            .map(|k| low * (ratio * k as f64).exp())
            .collect();
        let turns: Vec<f64> = omegas.iter().map(|omega| omega * period).collect();
        Self {
            responses: basis.frequency_responses(measured.theta, &turns),
            omegas,
        }
    }
}

#[derive(Clone, Copy)]
enum FrequencyMetric {
    Bandwidth,
    QuarterTurn,
}

/// Something that comes down to zero at the frequency that is sought.
struct Falling<'a> {
    measured: &'a Measured<'a>,
    quantity: FrequencyMetric,
    folding: &'a Folding,
    /// Standard deviations to each side.
    critical: f64,
}

impl Falling<'_> {
    /// About the lowest frequency `zero` at which it does, if it does.
    fn interval(&self, zero: Option<f64>) -> Interval {
        let Some(omega) = zero else {
            return Interval::new(f64::INFINITY, f64::INFINITY, f64::INFINITY);
        };
        // Slope and standard deviation at the crossing give a first guess of the bounds.
        let h = 1e-3 * omega;
        let at = |omega: f64| self.value_and_sd(omega);
        let sd = at(omega).1;
        let slope = (at(omega + h).0 - at(omega - h).0) / (2.0 * h);
        let reach = (self.critical * sd + self.bias(omega)) / slope.abs();
        // Highest frequency that samples show \[rad/s\].
        let highest = PI / self.measured.timing.sample_period_s;
        // `side` is -1 for the lower bound, where the value is still surely above zero.
        let bound = |side: f64| {
            let excess = |omega: f64| {
                let (value, sd) = at(omega);
                -side * value - self.critical * sd - self.bias(omega)
            };
            let mut near = (omega, excess(omega));
            let mut step = FIRST_STEP * reach;
            for _ in 0..STEPS {
                let place = (omega + side * step).clamp(0.0, highest);
                let far = (place, excess(place));
                if far.1 > 0.0 {
                    return zero_between(near, far, excess);
                }
                if place <= 0.0 || place >= highest {
                    break;
                }
                near = far;
                step *= 2.0;
            }
            f64::INFINITY
        };
        if reach == 0.0 {
            return Interval::new(omega, omega, omega);
        }
        Interval::new(omega, bound(-1.0), bound(1.0))
    }

    /// What comes down to zero, linear in the response, and its standard deviation: how far the
    /// magnitude is above 3 dB below the gain, or the part of the response that has the phase of the
    /// gain.
    fn value_and_sd(&self, omega: f64) -> (f64, f64) {
        let Measured {
            basis,
            theta,
            timing,
            ..
        } = self.measured;
        let (re_row, im_row) = basis.frequency_rows(omega * timing.sample_period_s);
        let gain = theta[0];
        let (re, im, constant) = match self.quantity {
            FrequencyMetric::Bandwidth => {
                let (re, im) = (dot(&re_row, theta), dot(&im_row, theta));
                let factor = SQRT_2 * timing.magnitude_factor(omega) / re.hypot(im);
                (factor * re, factor * im, -gain.signum())
            }
            FrequencyMetric::QuarterTurn => {
                let (sin, cos) = timing.phase_lead(omega).sin_cos();
                (gain.signum() * cos, -gain.signum() * sin, 0.0)
            }
        };
        let mut weights: Vec<f64> = re_row
            .iter()
            .zip(&im_row)
            .map(|(re_k, im_k)| re * re_k + im * im_k)
            .collect();
        weights[0] += constant;
        let variance = dot(&weights, &times(&self.measured.covariance, &weights));
        (dot(&weights, theta), not_negative(variance).sqrt())
    }

    /// What left-out frequencies, the steps of the sensor and folding may do to the value.
    fn bias(&self, omega: f64) -> f64 {
        let Measured {
            basis,
            theta,
            timing,
            ..
        } = self.measured;
        let of_response = self.measured.bias_at(omega) + self.folding.at(self.measured, omega);
        match self.quantity {
            FrequencyMetric::Bandwidth => {
                let (re, im) = basis.frequency_response(theta, omega * timing.sample_period_s);
                // Across the estimate an error adds to the magnitude by its square.
                let across = of_response.powi(2) / (2.0 * re.hypot(im));
                let factor = SQRT_2 * timing.magnitude_factor(omega);
                factor * (of_response + across) + self.measured.bias_at(0.0)
            }
            FrequencyMetric::QuarterTurn => of_response,
        }
    }
}

impl FrequencyMetric {
    /// The lowest frequency of the scan where the value has come down to zero.
    fn first_zero(self, measured: &Measured<'_>, scan: &Scan) -> Option<f64> {
        let indicator = self.indicator(measured);
        let points = scan.omegas.iter().zip(&scan.responses);
        let mut before: Option<(f64, f64)> = None;
        for (&omega, &response) in points {
            let value = indicator(
                omega,
                response,
                before.map_or(FRAC_PI_2, |(_, value)| value),
            );
            if let Some(inside) = before.filter(|(_, before)| *before > 0.0 && value <= 0.0) {
                let (basis, theta) = (&measured.basis, measured.theta);
                let period = measured.timing.sample_period_s;
                let at = |omega: f64| {
                    indicator(omega, basis.frequency_response(theta, omega * period), 0.0)
                };
                return Some(zero_between(inside, (omega, value), at));
            }
            before = Some((omega, value));
        }
        None
    }

    /// (ω, G, value nearby) to what the scan follows: the logarithm of the magnitude over 3 dB below
    /// the gain, or the phase over -90 degrees on the branch next to the one nearby.
    fn indicator(self, measured: &Measured<'_>) -> impl Fn(f64, (f64, f64), f64) -> f64 + use<> {
        let (timing, gain) = (measured.timing, measured.theta[0]);
        move |omega, (re, im), near| match self {
            FrequencyMetric::Bandwidth => {
                (re.hypot(im) * timing.magnitude_factor(omega) * SQRT_2 / gain.abs()).ln()
            }
            FrequencyMetric::QuarterTurn => {
                let (re, im) = (re * gain.signum(), im * gain.signum());
                let phase = im.atan2(re) + timing.phase_lead(omega) + FRAC_PI_2;
                phase - 2.0 * PI * ((phase - near) / (2.0 * PI)).round()
            }
        }
    }
}

/// Where a function is zero between two places at which its values have different signs: regula falsi
/// that halves the value of an end that stays (the Illinois rule), so both ends close in.
fn zero_between(mut a: (f64, f64), mut b: (f64, f64), value: impl Fn(f64) -> f64) -> f64 {
    for _ in 0..60 {
        if (b.0 - a.0).abs() <= 1e-12 * b.0.abs() || b.1 == 0.0 {
            break;
        }
        let place = (a.0 * b.1 - b.0 * a.1) / (b.1 - a.1);
        let found = (place, value(place));
        if (found.1 > 0.0) == (b.1 > 0.0) {
            a.1 /= 2.0;
        } else {
            a = b;
        }
        b = found;
    }
    b.0
}

/// Bounds of the errors that no covariance contains, at each of `omegas` \[rad/s\].
pub(crate) fn bias(measured: &Measured<'_>, omegas: &[f64]) -> Vec<f64> {
    let scan = Scan::new(measured);
    let folding = Folding::new(
        measured,
        FrequencyMetric::Bandwidth.first_zero(measured, &scan),
    );
    let at = |&omega: &f64| measured.bias_at(omega) + folding.at(measured, omega);
    omegas.iter().map(at).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_abs_diff_eq;

    #[test]
    fn zeros_of_straight_bent_and_steep_functions_are_found() {
        let zero = |f: &dyn Fn(f64) -> f64| zero_between((0.0, f(0.0)), (3.0, f(3.0)), f);
        assert_abs_diff_eq!(zero(&|x| x - 0.3), 0.3, epsilon = 1e-12);
        assert_abs_diff_eq!(zero(&|x| 2.0 - x * x), SQRT_2, epsilon = 1e-12);
        assert_abs_diff_eq!(
            zero(&|x| 1.0 - (5.0 * (x - 2.0)).exp()),
            2.0,
            epsilon = 1e-12
        );
    }
}
