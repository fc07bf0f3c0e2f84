//! The numbers that people ask for, read off the responses.

use serde::{Deserialize, Serialize};

use crate::frequency::FrequencyResponse;
use crate::step::StepResponse;

/// A value with its bounds; `None` where the responses do not determine it.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Interval {
    /// Best estimate.
    pub value: Option<f64>,
    /// Lower bound.
    pub lower: Option<f64>,
    /// Upper bound.
    pub upper: Option<f64>,
}

impl Interval {
    fn of_value(value: Option<f64>) -> Self {
        Self {
            value: value.filter(|value| value.is_finite()),
            lower: None,
            upper: None,
        }
    }
}

/// Figures of the responses.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Metrics {
    /// Final value of the step response \[output per input\].
    pub dc_gain: Interval,
    /// From 10 to 90 % of the final value \[s\].
    pub rise_time_s: Interval,
    /// Until the response stays within 2 % of the final value \[s\].
    pub settling_time_s: Interval,
    /// Highest point above the final value \[% of it\].
    pub overshoot_percent: Interval,
    /// Until 5 % of the final value \[s\].
    pub delay_s: Interval,
    /// Where the magnitude has fallen by 3 dB from its value at rest \[rad/s\].
    pub bandwidth_rad_s: Interval,
}

impl Metrics {
    /// Reads the figures off.
    #[must_use]
    pub fn new(step: &StepResponse, frequency: &FrequencyResponse) -> Self {
        let last = step.value.len() - 1;
        let gain = step.value[last];
        let period = step.time_s.get(1).copied().unwrap_or(0.0);
        let relative: Vec<f64> = step.value.iter().map(|value| value / gain).collect();
        let at = |share: f64| crossing(&relative, share).map(|samples| samples * period);
        let rise = at(0.9).zip(at(0.1)).map(|(late, early)| late - early);
        let overshoot = relative.iter().fold(1.0f64, |a, &b| a.max(b)) - 1.0;
        let bandwidth = {
            let start = frequency.magnitude_db.first().copied().unwrap_or(0.0);
            let fall: Vec<f64> = frequency.magnitude_db.iter().map(|db| start - db).collect();
            let half_power = 10.0 * 2f64.log10();
            crossing(&fall, half_power).map(|at| {
                let (k, part) = (at.floor() as usize, at.fract());
                let omega = |k: usize| frequency.omega_rad_s[k.min(fall.len() - 1)];
                omega(k) + part * (omega(k + 1) - omega(k))
            })
        };
        Self {
            dc_gain: Interval {
                value: Some(gain),
                lower: Some(step.pointwise.lower[last]),
                upper: Some(step.pointwise.upper[last]),
            },
            rise_time_s: Interval::of_value(rise),
            settling_time_s: Interval::of_value(
                last_outside(&relative, 0.02).map(|samples| samples * period),
            ),
            overshoot_percent: Interval::of_value(Some(100.0 * overshoot)),
            delay_s: Interval::of_value(at(0.05)),
            bandwidth_rad_s: Interval::of_value(bandwidth),
        }
    }
}

/// Where `values` first reach `level`, in samples, interpolated.
fn crossing(values: &[f64], level: f64) -> Option<f64> {
    let k = values.iter().position(|&value| value >= level)?;
    if k == 0 {
        return Some(0.0);
    }
    let (before, after) = (values[k - 1], values[k]);
    Some((k - 1) as f64 + (level - before) / (after - before))
}

/// When `values` last come within `band` of one, in samples, interpolated. `None` when they
/// arrive only with the last sample, which is one by definition.
fn last_outside(values: &[f64], band: f64) -> Option<f64> {
    let Some(k) = values.iter().rposition(|value| (value - 1.0).abs() > band) else {
        return Some(0.0);
    };
    if k + 2 >= values.len() {
        return None;
    }
    let (outside, inside) = ((values[k] - 1.0).abs(), (values[k + 1] - 1.0).abs());
    let inside = if (values[k] > 1.0) == (values[k + 1] > 1.0) {
        inside
    } else {
        -inside
    };
    Some(k as f64 + (outside - band) / (outside - inside))
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_abs_diff_eq;

    #[test]
    fn crossings_are_interpolated() {
        assert_abs_diff_eq!(
            crossing(&[0.0, 0.2, 1.0], 0.6).unwrap(),
            1.5,
            epsilon = 1e-12
        );
        assert_eq!(crossing(&[0.0, 0.2], 0.6), None);
        let values = [0.0, 1.3, 0.9, 1.0, 1.0, 1.0];
        assert_abs_diff_eq!(last_outside(&values, 0.05).unwrap(), 2.5, epsilon = 1e-12);
        assert_eq!(last_outside(&[0.0, 0.5, 1.0], 0.05), None);
    }
}
