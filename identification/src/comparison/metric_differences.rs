//! The metrics of both sides and their differences.

use super::outcome::MetricDifference;
use super::run_means::RunMeans;
use crate::results::{Interval, Metrics};

/// Metric by metric. The interval of a difference contains the scatter of the `runs`, where these serve for that.
pub(super) fn metric_differences(
    a: &Metrics,
    b: &Metrics,
    runs: Option<&RunMeans>,
) -> Vec<MetricDifference> {
    let both = a.named().into_iter().zip(b.named()).enumerate();
    both.map(|(place, ((metric, a), (_, b)))| {
        let of_noise = of_metric(metric, &a, &b);
        match runs {
            Some(runs) => of_servos(of_noise, runs.metric_half(place)),
            None => of_noise,
        }
    })
    .collect()
}

/// The same with an interval of the difference that reaches `half` to each side at least.
fn of_servos(found: MetricDifference, half: Option<f64>) -> MetricDifference {
    let difference = Interval {
        value: found.difference,
        lower: found.lower,
        upper: found.upper,
    };
    let difference = difference.at_least_as_wide(half);
    MetricDifference {
        lower: difference.lower,
        upper: difference.upper,
        ..found
    }
}

fn of_metric(metric: &str, a: &Interval, b: &Interval) -> MetricDifference {
    let bounds = |of: &Interval| of.lower.zip(of.upper).map(<[f64; 2]>::from);
    let difference = b.value.zip(a.value).map(|(b, a)| b - a);
    let reach = |b_from: Option<f64>, b_to: Option<f64>, a_from: Option<f64>, a_to: Option<f64>| {
        Some((b_to? - b_from?).hypot(a_to? - a_from?))
    };
    let below = reach(b.lower, b.value, a.value, a.upper);
    let above = reach(b.value, b.upper, a.lower, a.value);
    MetricDifference {
        metric: metric.to_owned(),
        a: a.value,
        a_bounds: bounds(a),
        b: b.value,
        b_bounds: bounds(b),
        difference,
        lower: difference.zip(below).map(|(d, below)| d - below),
        upper: difference.zip(above).map(|(d, above)| d + above),
    }
}
