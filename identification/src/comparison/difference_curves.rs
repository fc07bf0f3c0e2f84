//! The difference of the step responses, stroke by stroke.

use super::difference::Differences;
use super::outcome::{CurveBounds, DifferenceCurve, Direction};
use crate::data::Timing;
use crate::results::Interval;

/// The curves; `shift_of` gives the delay shift of some of them \[s\], and the remainder that it does not explain
/// \[% of the final value\].
pub(super) fn difference_curves(
    differences: &Differences,
    timing: Timing,
    shift_of: impl Fn(std::ops::Range<usize>) -> (Interval, Option<f64>),
) -> Vec<DifferenceCurve> {
    let strokes: &[Direction] = match differences.curves() {
        1 => &[Direction::Both],
        _ => &[Direction::Up, Direction::Down],
    };
    let curve = |(index, &stroke): (usize, &Direction)| {
        let (value, half) = differences.curve(index);
        let bounds = half.map(|half| {
            let at = |side: f64| {
                let bound = |(d, h): (&f64, &f64)| 100.0 * (d + side * h);
                value.iter().zip(half).map(bound).collect()
            };
            CurveBounds {
                lower: at(-1.0),
                upper: at(1.0),
            }
        });
        let (delay_shift_s, shift_leaves_percent) = shift_of(index..index + 1);
        DifferenceCurve {
            stroke,
            time_s: (0..value.len()).map(|m| timing.seconds(m as f64)).collect(),
            percent: value.iter().map(|d| 100.0 * d).collect(),
            bounds,
            delay_shift_s,
            shift_leaves_percent,
        }
    };
    strokes.iter().enumerate().map(curve).collect()
}
