//! Whether a shift in time is all that two sides are seen to differ by.
//!
//! Every difference of two responses has a shift that brings them closest. It is all of the difference only where it is surely one, where nothing but noise
//! is left behind it, where no other metric surely differs, and where the recordings would show it if the second were slower and not later: a response
//! that is stretched by the shift at its half way has a bandwidth that is smaller by the same share.

use super::outcome::{Comparison, DifferenceCurve, MetricDifference};
use crate::results::Interval;
use crate::thresholds::{LEFT_BY_A_SHIFT_PERCENT, NOTABLE_SHIFT_S};

/// What a shift in time is of the difference between two sides.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum ShiftIs {
    /// All that these recordings show.
    All,
    /// Not all: behind the best shift the responses, each relative to its own end, are this far apart \[%\].
    NotAll(f64),
    /// None, or the recordings do not show which of the two.
    Unknown,
}

impl ShiftIs {
    pub(super) fn of(found: &Comparison) -> Self {
        let curves = &found.curves;
        let is_sure = |curve: &DifferenceCurve| is_surely_a_shift(&curve.delay_shift_s);
        if !curves.iter().any(is_sure) {
            return Self::Unknown;
        }
        let left = curves.iter().filter_map(|c| c.shift_leaves_percent);
        let left = left.fold(0.0, f64::max);
        if left >= LEFT_BY_A_SHIFT_PERCENT && !curves.iter().all(|c| c.shift_leaves_noise) {
            return Self::NotAll(left);
        }
        let is_all = |curve: &DifferenceCurve| {
            let left = curve
                .shift_leaves_percent
                .zip(curve.shift_between_rows_percent);
            let left = left.filter(|_| curve.shift_leaves_noise);
            let is_little = |(left, more): (f64, f64)| left + more < LEFT_BY_A_SHIFT_PERCENT;
            is_sure(curve) && left.is_some_and(is_little)
        };
        let no_slower = curves
            .iter()
            .all(|curve| is_not_slower(found, curve.delay_shift_s.value));
        match curves.iter().all(is_all) && has_no_other_difference(found) && no_slower {
            true => Self::All,
            false => Self::Unknown,
        }
    }
}

/// Whether the interval leaves no doubt that there is a shift, and it is one that counts.
fn is_surely_a_shift(shift: &Interval) -> bool {
    let is_notable = shift
        .value
        .is_some_and(|value| value.abs() >= NOTABLE_SHIFT_S);
    is_notable && shift.lower.is_some() && shift.upper.is_some() && !shift.contains(0.0)
}

/// Whether waits may make the responses differ beyond the margin, of which each side has one of its own, of up to `waits_s`: a shift within them is possible, and what it leaves is within the
/// margin.
pub(super) fn may_be_waits(found: &Comparison, waits_s: [f64; 2]) -> bool {
    let [of_first, of_second] = waits_s;
    let is_explained = |curve: &DifferenceCurve| {
        let shift = &curve.delay_shift_s;
        let ends = shift.ends();
        let is_possible =
            ends.is_some_and(|[lower, upper]| lower <= of_second && upper >= -of_first);
        let left = curve.shift_leaves_at_least_percent;
        is_possible && left.is_some_and(|left| left <= found.margin_percent)
    };
    waits_s != [0.0; 2] && found.curves.iter().all(is_explained)
}

/// Metrics that a mere shift leaves as they are.
const UNMOVED: [&str; 4] = [
    "dc_gain",
    "rise_time_s",
    "overshoot_percent",
    "bandwidth_rad_s",
];

/// Whether no metric that a shift leaves as it is surely differs, and gain and bandwidth are known at all: rise and overshoot of a smooth response may not be.
fn has_no_other_difference(found: &Comparison) -> bool {
    let is_alike = |name: &str| match known(found, name) {
        Some((_, [lower, upper])) => lower <= 0.0 && upper >= 0.0,
        None => !matches!(name, "dc_gain" | "bandwidth_rad_s"),
    };
    let same_gain = known(found, "dc_gain").is_some_and(|(row, ends)| {
        let most = ends
            .into_iter()
            .fold(0.0, |most: f64, end| most.max(end.abs()));
        row.a
            .is_some_and(|gain| most < found.margin_percent / 100.0 * gain.abs())
    });
    same_gain && UNMOVED.into_iter().all(is_alike)
}

/// Whether the bandwidths exclude that the second is slower, or quicker, by as much as would make this shift half way.
fn is_not_slower(found: &Comparison, shift_s: Option<f64>) -> bool {
    let half_way = found.differences.iter().find(|row| row.metric == "t50_s");
    let found = shift_s
        .zip(half_way.and_then(|row| row.a))
        .zip(known(found, "bandwidth_rad_s"));
    found.is_some_and(|((shift, half_way), (row, [lower, upper]))| {
        let slower = shift / half_way.max(f64::MIN_POSITIVE);
        let change = row.a.unwrap_or_default() * (1.0 / (1.0 + slower) - 1.0);
        !(lower..=upper).contains(&change)
    })
}

/// A metric of both sides and the interval of its difference.
fn known<'f>(found: &'f Comparison, name: &str) -> Option<(&'f MetricDifference, [f64; 2])> {
    let row = found.differences.iter().find(|row| row.metric == name)?;
    Some((row, [row.lower?, row.upper?]))
}
