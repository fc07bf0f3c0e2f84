//! Axes of Bode plots, with ticks that can be read: 1, 2 and 5 of each decade, and quarters of a turn.

use plotters::coord::combinators::{IntoLogRange, LogCoord};
use plotters::coord::ranged1d::{KeyPointHint, NoDefaultFormatting, Ranged, ValueFormatter};
use plotters::coord::types::RangedCoordf64;
use std::ops::Range;

/// An axis with ticks of its own.
pub(super) struct Axis<C> {
    scale: C,
    ticks: fn(Range<f64>) -> Vec<f64>,
}

/// A logarithmic axis.
pub(super) fn decades(range: Range<f64>) -> Axis<LogCoord<f64>> {
    Axis {
        scale: range.log_scale().into(),
        ticks: |Range { start, end }| {
            let (first, last) = (start.log10().floor() as i32, end.log10().ceil() as i32);
            // Powers of ten below 1 are not exact; their digits are.
            let tick = |decade: i32, digit: u8| format!("{digit}e{decade}").parse().ok();
            (first..=last)
                .flat_map(|decade| [1, 2, 5].map(|digit| tick(decade, digit)))
                .flatten()
                .filter(|tick| (start..=end).contains(tick))
                .collect()
        },
    }
}

/// A linear axis of degrees.
pub(super) fn quarter_turns(range: Range<f64>) -> Axis<RangedCoordf64> {
    Axis {
        scale: range.into(),
        ticks: |Range { start, end }| {
            let quarters = (start / 90.0).ceil() as i32..=(end / 90.0).floor() as i32;
            quarters.map(|quarter| 90.0 * f64::from(quarter)).collect()
        },
    }
}

impl<C: Ranged<ValueType = f64>> Ranged for Axis<C> {
    type FormatOption = NoDefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, limit: (i32, i32)) -> i32 {
        self.scale.map(value, limit)
    }

    fn key_points<Hint: KeyPointHint>(&self, _: Hint) -> Vec<f64> {
        (self.ticks)(self.range())
    }

    fn range(&self) -> Range<f64> {
        self.scale.range()
    }
}

impl<C: Ranged<ValueType = f64>> ValueFormatter<f64> for Axis<C> {
    fn format_ext(&self, value: &f64) -> String {
        value.to_string()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_numbers() {
        let tens = decades(0.07..30.0).key_points(8);
        assert_eq!(tens, [0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0]);
        let turns = quarter_turns(-200.0..10.0).key_points(8);
        assert_eq!(turns, [-180.0, -90.0, 0.0]);
        assert_eq!(decades(1.0..3.0).format_ext(&0.2), "0.2");
    }
}
