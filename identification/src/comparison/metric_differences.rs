//! The metrics of both sides and their differences.

use super::outcome::MetricDifference;
use super::run_means::RunMeans;
use crate::results::{Interval, Metrics};

/// The metrics of one side.
pub(super) struct MetricsOfSide {
    /// Their intervals allow for output that was recorded earlier or later than it is taken for.
    pub(super) metrics: Metrics,
    /// These do not: an error that both sides share is in no difference.
    pub(super) at_stated_delay: Metrics,
}

/// Metric by metric. The intervals of both sides and of their difference contain the scatter of the `runs`, where these serve for that. That of a difference contains the errors
/// of both delays where they are `two_delay_errors`: each is a limit, so that they add up. That of the gain contains that the second output may be off
/// by the share `scale_error` in terms of the first.
pub(super) fn metric_differences(
    [a, b]: &[MetricsOfSide; 2],
    runs: Option<&RunMeans>,
    two_delay_errors: bool,
    scale_error: f64,
) -> Vec<MetricDifference> {
    let stated = [a, b].map(|side| side.at_stated_delay.named());
    let shown = [a, b].map(|side| side.metrics.named());
    let of_place = |place: usize| {
        let [(metric, stated_a), (_, stated_b)] = stated.map(|side| side[place]);
        let [(_, shown_a), (_, shown_b)] = shown.map(|side| side[place]);
        let mut between = difference(&stated_a, &stated_b);
        if let Some(runs) = runs {
            between = between.at_least_as_wide(runs.metric_half(place));
        }
        if two_delay_errors {
            let [(below_a, above_a), (below_b, above_b)] =
                [(shown_a, stated_a), (shown_b, stated_b)].map(|(shown, stated)| {
                    let by = |a: Option<f64>, b: Option<f64>| a.zip(b).map_or(0.0, |(a, b)| a - b);
                    (by(stated.lower, shown.lower), by(shown.upper, stated.upper))
                });
            between = between.reaching(below_b + above_a, above_b + below_a);
        }
        if metric == "dc_gain" {
            between = with_error(between, shown_b.value.map(|gain| scale_error * gain));
        }
        let bounds = |side: usize, of: Interval| {
            let of = match runs {
                Some(runs) => of.at_least_as_wide(runs.metric_half_of(side, place)),
                None => of,
            };
            // None but the gain is below zero.
            let least = if metric == "dc_gain" {
                f64::NEG_INFINITY
            } else {
                0.0
            };
            let lower = of.lower.map(|lower| lower.max(least));
            lower.zip(of.upper).map(<[f64; 2]>::from)
        };
        MetricDifference {
            metric: metric.to_owned(),
            a: shown_a.value,
            a_bounds: bounds(0, shown_a),
            b: shown_b.value,
            b_bounds: bounds(1, shown_b),
            difference: between.value,
            lower: between.lower,
            upper: between.upper,
        }
    };
    (0..stated[0].len()).map(of_place).collect()
}

/// The interval with an `error` that has nothing to do with what it contains.
fn with_error(of: Interval, error: Option<f64>) -> Interval {
    let value = of.value.zip(error);
    let beyond = |bound: Option<f64>| {
        let (bound, (value, error)) = bound.zip(value)?;
        Some((bound - value).hypot(error))
    };
    let (below, above) = (beyond(of.lower), beyond(of.upper));
    Interval {
        lower: of.value.zip(below).map(|(value, below)| value - below),
        upper: of.value.zip(above).map(|(value, above)| value + above),
        ..of
    }
}

/// Second less first, from the intervals of both.
fn difference(a: &Interval, b: &Interval) -> Interval {
    let value = b.value.zip(a.value).map(|(b, a)| b - a);
    let reach = |b_from: Option<f64>, b_to: Option<f64>, a_from: Option<f64>, a_to: Option<f64>| {
        Some((b_to? - b_from?).hypot(a_to? - a_from?))
    };
    let below = reach(b.lower, b.value, a.value, a.upper);
    let above = reach(b.value, b.upper, a.lower, a.value);
    Interval {
        value,
        lower: value.zip(below).map(|(d, below)| d - below),
        upper: value.zip(above).map(|(d, above)| d + above),
    }
}
