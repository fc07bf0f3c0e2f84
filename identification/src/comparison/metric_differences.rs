//! The metrics of both sides and their differences.

use super::outcome::MetricDifference;
use crate::results::{Interval, Metrics};

pub(super) fn metric_differences(a: &Metrics, b: &Metrics) -> Vec<MetricDifference> {
    let both = a.named().into_iter().zip(b.named());
    both.map(|((metric, a), (_, b))| of_metric(metric, &a, &b))
        .collect()
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
