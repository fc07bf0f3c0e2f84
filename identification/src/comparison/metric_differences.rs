//! The metrics of both sides and their differences.

use super::outcome::MetricDifference;
use crate::results::{Interval, Metrics};

/// How to read a metric.
type Metric = fn(&Metrics) -> Interval;

pub(super) fn metric_differences(a: &Metrics, b: &Metrics) -> Vec<MetricDifference> {
    let all: [(&str, Metric); 8] = [
        ("dc_gain", |m| m.dc_gain),
        ("delay_s", |m| m.delay_s),
        ("t50_s", |m| m.t50_s),
        ("rise_time_s", |m| m.rise_time_s),
        ("overshoot_percent", |m| m.overshoot_percent),
        ("settling_time_s", |m| m.settling_time_s),
        ("bandwidth_rad_s", |m| m.bandwidth_rad_s),
        ("phase_minus_90_rad_s", |m| m.phase_minus_90_rad_s),
    ];
    let bounds = |of: &Interval| of.lower.zip(of.upper).map(<[f64; 2]>::from);
    all.iter()
        .map(|(name, of)| {
            let (a, b) = (of(a), of(b));
            let difference = b.value.zip(a.value).map(|(b, a)| b - a);
            let away =
                |from: Option<f64>, to: Option<f64>| from.zip(to).map(|(from, to)| to - from);
            let bound = |b_part: Option<f64>, a_part: Option<f64>| {
                b_part.zip(a_part).map(|(x, y)| x.hypot(y))
            };
            let below = bound(away(b.lower, b.value), away(a.value, a.upper));
            let above = bound(away(b.value, b.upper), away(a.lower, a.value));
            MetricDifference {
                metric: (*name).to_owned(),
                a: a.value,
                a_bounds: bounds(&a),
                b: b.value,
                b_bounds: bounds(&b),
                difference,
                lower: difference.zip(below).map(|(d, below)| d - below),
                upper: difference.zip(above).map(|(d, above)| d + above),
            }
        })
        .collect()
}
