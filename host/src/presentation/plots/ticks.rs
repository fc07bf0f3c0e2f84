//! Axes of Bode plots, with ticks that can be read: 1, 2 and 5 of each decade, and quarters of a turn.

use plotters::coord::combinators::{IntoLogRange, LogCoord};
use plotters::coord::ranged1d::{KeyPointHint, NoDefaultFormatting, Ranged, ValueFormatter};
use plotters::coord::types::RangedCoordf64;
use std::ops::Range;

/// A logarithmic axis.
pub(super) struct Decades(LogCoord<f64>);

impl From<Range<f64>> for Decades {
    fn from(range: Range<f64>) -> Self {
        Self(range.log_scale().into())
    }
}

impl Ranged for Decades {
    type FormatOption = NoDefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, limit: (i32, i32)) -> i32 {
        self.0.map(value, limit)
    }

    fn key_points<Hint: KeyPointHint>(&self, _: Hint) -> Vec<f64> {
        let Range { start, end } = self.0.range();
        let (first, last) = (start.log10().floor() as i32, end.log10().ceil() as i32);
        // Powers of ten below 1 are not exact; their digits are.
        let tick = |decade: i32, digit: u8| format!("{digit}e{decade}").parse().ok();
        (first..=last)
            .flat_map(|decade| [1, 2, 5].map(|digit| tick(decade, digit)))
            .flatten()
            .filter(|tick| (start..=end).contains(tick))
            .collect()
    }

    fn range(&self) -> Range<f64> {
        self.0.range()
    }
}

impl ValueFormatter<f64> for Decades {
    fn format_ext(&self, value: &f64) -> String {
        value.to_string()
    }
}

/// A linear axis of degrees.
pub(super) struct QuarterTurns(RangedCoordf64);

impl From<Range<f64>> for QuarterTurns {
    fn from(range: Range<f64>) -> Self {
        Self(range.into())
    }
}

impl Ranged for QuarterTurns {
    type FormatOption = NoDefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, limit: (i32, i32)) -> i32 {
        self.0.map(value, limit)
    }

    fn key_points<Hint: KeyPointHint>(&self, _: Hint) -> Vec<f64> {
        let Range { start, end } = self.0.range();
        let quarters = (start / 90.0).ceil() as i32..=(end / 90.0).floor() as i32;
        quarters.map(|quarter| 90.0 * f64::from(quarter)).collect()
    }

    fn range(&self) -> Range<f64> {
        self.0.range()
    }
}

impl ValueFormatter<f64> for QuarterTurns {
    fn format_ext(&self, value: &f64) -> String {
        value.to_string()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_numbers() {
        let decades = Decades::from(0.07..30.0).key_points(8);
        assert_eq!(decades, [0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0]);
        let turns = QuarterTurns::from(-200.0..10.0).key_points(8);
        assert_eq!(turns, [-180.0, -90.0, 0.0]);
        assert_eq!(Decades::from(1.0..3.0).format_ext(&0.2), "0.2");
    }
}
