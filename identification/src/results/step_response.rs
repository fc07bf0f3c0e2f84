//! The step response and its bands.

use serde::{Deserialize, Serialize};

use crate::estimation::CurveVariance;
use crate::numerics::{pointwise_critical, simultaneous_critical};
use crate::options::LEVELS;
use crate::results::usable_numbers::{LARGEST, is_sized, is_usable};
use crate::results::validity::Bounds;

/// Bounds that hold point by point: each single point is inside with the stated probability. The
/// whole curve is inside far less often. The last ones are those of the final value alone.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PointwiseBand {
    /// Lower bounds.
    pub lower: Vec<f64>,
    /// Upper bounds.
    pub upper: Vec<f64>,
}

/// Bounds that hold for all points at once: the whole curve is inside with the stated probability. The last ones hold both the final value and the response at that time.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SimultaneousBand {
    /// Standard deviations to each side, before Student's correction.
    pub critical_value: f64,
    /// Lower bounds.
    pub lower: Vec<f64>,
    /// Upper bounds.
    pub upper: Vec<f64>,
}

/// Response to a unit step applied at sample 0.
///
/// The last element is the **final value** G0, the gain: everything that the response still does
/// after N samples is gathered there. It is not the value at the time N·Ts.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct StepResponse {
    /// 0, Ts, ..., (N-1) Ts \[s\].
    pub time_s: Vec<f64>,
    /// The response \[output per input\].
    pub value: Vec<f64>,
    /// Its bounds, where they hold.
    #[serde(flatten)]
    pub bounds: Bounds<StepBounds>,
}

/// The uncertainty of a step response.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct StepBounds {
    /// Confidence level of both bands.
    pub level: f64,
    /// Standard deviation of each value, from the noise alone.
    pub sd: Vec<f64>,
    /// Bounds for single points.
    pub pointwise: PointwiseBand,
    /// Bounds for the whole curve.
    pub simultaneous: SimultaneousBand,
    /// Bound of the error from leaving out high frequencies; it is part of both bands. 0 when
    /// n = N.
    pub truncation_bias: f64,
    /// Bound of the error from the steps of the sensor, where they are larger than the noise; it is
    /// part of both bands too.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub rounding_bias: f64,
}

/// For serde, which hands over a reference.
#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde's signature")]
pub(super) fn is_zero(value: &f64) -> bool {
    *value == 0.0
}

/// Bounds of errors that no standard deviation contains \[output per input\].
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Biases {
    /// From leaving out high frequencies.
    pub truncation: f64,
    /// From the steps of the sensor.
    pub rounding: f64,
}

impl StepResponse {
    /// A response of which `bounds` are known.
    #[must_use]
    pub fn new(sample_period_s: f64, value: Vec<f64>, bounds: Bounds<StepBounds>) -> Self {
        Self {
            time_s: (0..value.len())
                .map(|m| m as f64 * sample_period_s)
                .collect(),
            value,
            bounds,
        }
    }

    /// Whether it has `points` points, with numbers that can be computed with.
    pub(super) fn is_consistent(&self, points: usize) -> bool {
        let sized = |values: &[f64]| is_sized(values, points);
        let bounds = self.bounds.valid().is_none_or(|bounds| {
            let (each, whole) = (&bounds.pointwise, &bounds.simultaneous);
            LEVELS.contains(&bounds.level)
                && (0.0..=LARGEST).contains(&bounds.truncation_bias)
                && (0.0..=LARGEST).contains(&bounds.rounding_bias)
                && is_usable(&whole.critical_value)
                && sized(&bounds.sd)
                && [&each.lower, &each.upper, &whole.lower, &whole.upper]
                    .into_iter()
                    .all(|values| sized(values))
        });
        bounds && sized(&self.time_s) && sized(&self.value)
    }
}

/// Ways in which runs scatter independently, each of which may miss: how far the servo goes, and how.
const WAYS_OF_RUNS: f64 = 2.0;

impl StepBounds {
    /// Draws both bands around `value`.
    ///
    /// # Panics
    /// When `spread` does not describe the points of `value`.
    #[must_use]
    pub fn new(value: &[f64], spread: &CurveVariance, level: f64, biases: Biases) -> Self {
        assert_eq!(
            value.len(),
            spread.sd.len(),
            "one standard deviation per value"
        );
        let correlation = match &spread.of_runs {
            Some(runs) => &runs.noise_correlation,
            None => &spread.neighbour_correlation,
        };
        let critical_value = simultaneous_critical(correlation, level);
        let bias = biases.truncation + biases.rounding;
        let bounds = |half: Vec<f64>| {
            let half = |m: usize| half[m] + bias;
            let at = |side: f64| {
                (0..value.len())
                    .map(|m| value[m] + side * half(m))
                    .collect()
            };
            (at(-1.0), at(1.0))
        };
        let half_widths = |critical: Vec<f64>| -> Vec<f64> {
            let each = critical.iter().zip(&spread.sd);
            each.map(|(c, sd)| c * sd).collect()
        };
        let (lower, upper) = bounds(half_widths(spread.critical(pointwise_critical(level))));
        let pointwise = PointwiseBand { lower, upper };
        // What differs from run to run moves all points together: Bonferroni's correction is for its ways.
        let of_runs = pointwise_critical(1.0 - (1.0 - level) / WAYS_OF_RUNS);
        let (mut lower, mut upper) = bounds(half_widths(
            spread.critical_of_parts(critical_value, of_runs),
        ));
        reach_to_the_one_before(&mut lower, f64::min);
        reach_to_the_one_before(&mut upper, f64::max);
        Self {
            level,
            sd: spread.sd.clone(),
            pointwise,
            simultaneous: SimultaneousBand {
                critical_value,
                lower,
                upper,
            },
            truncation_bias: biases.truncation,
            rounding_bias: biases.rounding,
        }
    }

    /// Bound of the errors that no standard deviation contains; it is part of both bands.
    #[must_use]
    pub fn bias(&self) -> f64 {
        self.truncation_bias + self.rounding_bias
    }

    /// The parts of that bound.
    #[must_use]
    pub fn biases(&self) -> Biases {
        Biases {
            truncation: self.truncation_bias,
            rounding: self.rounding_bias,
        }
    }

    /// The same for a response that may be up to `samples` earlier or later than it is taken for: at each point the bands are those of
    /// all points as near as that. The final value has no time.
    pub(crate) fn allow_for_delay_error(&mut self, samples: f64) {
        let (each, whole) = (&mut self.pointwise, &mut self.simultaneous);
        for lower in [&mut each.lower, &mut whole.lower] {
            *lower = farthest_within(samples, lower, f64::min);
        }
        for upper in [&mut each.upper, &mut whole.upper] {
            *upper = farthest_within(samples, upper, f64::max);
        }
    }

    /// Mean half width of the pointwise and of the simultaneous band.
    #[must_use]
    pub fn mean_half_widths(&self) -> (f64, f64) {
        let mean = |lower: &[f64], upper: &[f64]| {
            half_widths(lower, upper).sum::<f64>() / upper.len() as f64
        };
        (
            mean(&self.pointwise.lower, &self.pointwise.upper),
            mean(&self.simultaneous.lower, &self.simultaneous.upper),
        )
    }

    /// Half width of the simultaneous band where it is widest.
    #[must_use]
    pub fn widest_half_width(&self) -> f64 {
        half_widths(&self.simultaneous.lower, &self.simultaneous.upper).fold(0.0, f64::max)
    }
}

/// Has the last bound hold the response at its time, too, about which the final value says nothing where the response has not settled: it is taken for no
/// better known than a sample before. Of 182 such responses of multisines eight were outside of the bounds of the final value.
fn reach_to_the_one_before(bounds: &mut [f64], farther: fn(f64, f64) -> f64) {
    if let [.., before, last] = bounds {
        *last = farther(*last, *before);
    }
}

/// For each point but the last the farthest of all points of the line through `values` that are up to `reach` samples away.
pub(crate) fn farthest_within(
    reach: f64,
    values: &[f64],
    farther: fn(f64, f64) -> f64,
) -> Vec<f64> {
    let Some((&last, line)) = values.split_last().filter(|(_, line)| !line.is_empty()) else {
        return values.to_vec();
    };
    let end = line.len() - 1;
    let at = |time: f64| {
        let time = time.clamp(0.0, end as f64);
        let before = (time as usize).min(end);
        let after = (before + 1).min(end);
        line[before] + (time - before as f64) * (line[after] - line[before])
    };
    let point = |m: usize| {
        let (from, to) = (m as f64 - reach, m as f64 + reach);
        let between = (from.ceil().max(0.0) as usize)..=(to.floor() as usize).min(end);
        let between = line[between].iter().copied();
        between.chain([at(from), at(to)]).fold(line[m], farther)
    };
    (0..line.len()).map(point).chain([last]).collect()
}

fn half_widths(lower: &[f64], upper: &[f64]) -> impl Iterator<Item = f64> {
    upper.iter().zip(lower).map(|(u, l)| (u - l) / 2.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_bound_is_no_nearer_than_the_one_before() {
        let reaching = |mut bounds: Vec<f64>, farther: fn(f64, f64) -> f64| {
            reach_to_the_one_before(&mut bounds, farther);
            bounds
        };
        assert_eq!(reaching(vec![0.0, 1.6, 0.9], f64::max), [0.0, 1.6, 1.6]);
        assert_eq!(reaching(vec![0.0, 0.5, 0.9], f64::max), [0.0, 0.5, 0.9]);
        assert_eq!(reaching(vec![0.0, 0.4, 0.8], f64::min), [0.0, 0.4, 0.4]);
        assert_eq!(reaching(vec![0.7], f64::min), [0.7]);
    }

    #[test]
    fn a_band_that_may_be_earlier_or_later_holds_all_of_its_line_within_reach() {
        let band = [0.0, 0.0, 1.0, 3.0, 2.0, 9.0];
        // Up to half a sample away: the line is half way to its neighbours there.
        let upper = farthest_within(0.5, &band, f64::max);
        assert_eq!(upper, [0.0, 0.5, 2.0, 3.0, 2.5, 9.0]);
        let lower = farthest_within(1.5, &band, f64::min);
        assert_eq!(lower, [0.0, 0.0, 0.0, 0.5, 2.0, 9.0]);
        assert_eq!(farthest_within(0.0, &band, f64::max), band);
    }
}
