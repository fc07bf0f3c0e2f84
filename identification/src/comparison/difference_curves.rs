//! The difference of the step responses, stroke by stroke.

use super::difference::Differences;
use super::outcome::{CurveBounds, DifferenceCurve, Direction};
use super::shift::Remains;
use crate::data::Timing;
use crate::results::Interval;

/// The largest of what remains \[%\].
fn most(remains: &[Remains], of: fn(Remains) -> f64) -> Option<f64> {
    remains
        .iter()
        .map(|left| 100.0 * of(*left))
        .reduce(f64::max)
}

/// The curves; `shift_of` gives the delay shift of some of them \[s\], and what it leaves of them, sample by sample.
pub(super) fn difference_curves(
    differences: &Differences,
    timing: Timing,
    shift_of: impl Fn(std::ops::Range<usize>) -> (Interval, Vec<Remains>),
) -> Vec<DifferenceCurve> {
    let strokes: &[Direction] = match differences.curves() {
        1 => &[Direction::Both],
        _ => &[Direction::Up, Direction::Down],
    };
    let curve = |(index, &stroke): (usize, &Direction)| {
        let (value, half) = differences.curve(index);
        let bounds = half.as_ref().map(|half| {
            let at = |side: f64| {
                let bound = |(d, h): (&f64, &f64)| 100.0 * (d + side * h);
                value.iter().zip(*half).map(bound).collect()
            };
            CurveBounds {
                lower: at(-1.0),
                upper: at(1.0),
            }
        });
        let (delay_shift_s, remains) = shift_of(index..index + 1);
        let at_least = half.valid().filter(|_| !remains.is_empty()).map(|half| {
            let final_values = value.last().zip(half.last());
            let final_values = final_values.map_or(0.0, |(value, half)| value.abs() - half);
            let points = remains.iter().zip(*half);
            let left = points.map(|(left, half)| left.surely() - half);
            100.0 * left.fold(final_values.max(0.0), f64::max)
        });
        let is_noise = half.valid().is_some_and(|half| {
            let mut points = remains.iter().zip(*half);
            !remains.is_empty() && points.all(|(left, half)| left.surely() <= *half)
        });
        DifferenceCurve {
            stroke,
            time_s: (0..value.len()).map(|m| timing.seconds(m as f64)).collect(),
            percent: value.iter().map(|d| 100.0 * d).collect(),
            bounds,
            delay_shift_s,
            shift_leaves_percent: most(&remains, Remains::surely),
            shift_between_rows_percent: most(&remains, |left| left.by_interpolation),
            shift_leaves_at_least_percent: at_least,
            shift_leaves_noise: is_noise,
        }
    };
    strokes.iter().enumerate().map(curve).collect()
}
