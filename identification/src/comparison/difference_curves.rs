//! The difference of the step responses, stroke by stroke.

use super::difference::{Curves, Differences};
use super::outcome::{CurveBounds, DifferenceCurve, Stroke};
use super::shift;
use crate::data::Timing;
use crate::results::Interval;

/// How much later the second side moves.
pub(super) struct Later<'a> {
    pub(super) curves: &'a [Curves; 2],
    pub(super) level: f64,
    pub(super) period_s: f64,
    /// How much later after an edge the second side is sampled \[s\].
    pub(super) phases_s: f64,
}

impl Later<'_> {
    /// By how much on the curves with these numbers \[s\], and the remainder that such a delay does not explain
    /// \[% of the final value\].
    pub(super) fn by(&self, curves: std::ops::Range<usize>) -> (Interval, Option<f64>) {
        let [a, b] = self.curves;
        let found = shift::shift(a, b, curves, self.level);
        let seconds = |samples: f64| samples * self.period_s + self.phases_s;
        let percent = found.remains.map(|remains| 100.0 * remains);
        (found.samples.map(seconds), percent)
    }
}

pub(super) fn difference_curves(
    differences: &Differences,
    timing: Timing,
    later: &Later<'_>,
) -> Vec<DifferenceCurve> {
    let strokes: &[Stroke] = match differences.curves() {
        1 => &[Stroke::Both],
        _ => &[Stroke::Up, Stroke::Down],
    };
    let curve = |(index, &stroke): (usize, &Stroke)| {
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
        let (delay_shift_s, shift_leaves_percent) = later.by(index..index + 1);
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
