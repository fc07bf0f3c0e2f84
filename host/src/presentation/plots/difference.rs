//! The difference of two servos: the second step response less the first, with bounds and margin.

use super::figure::{Band, Curve, Figure, Ink, Legend, Panel, SINCE_EDGE_LABEL, milliseconds};
use crate::presentation::summary::percent;
use servoid_identification::comparison::{Comparison, CurveBounds, Direction};

/// The difference curves of a comparison of `a` with `b`, within bounds that hold for all of them at
/// once. The verdict is "different" where a band lies outside the margin somewhere, "same" where all
/// lie inside it everywhere.
#[must_use]
pub fn difference(name: &str, title: &str, a: &str, b: &str, found: &Comparison) -> Figure {
    let y_label = format!("{b} - {a} (% of the step)");
    let mut panel = Panel::new(SINCE_EDGE_LABEL, y_label, Legend::Above);
    for curve in &found.curves {
        let (stroke, ink) = match curve.stroke {
            Direction::Both => ("difference", Ink::Model),
            Direction::Up => ("up strokes", Ink::Model),
            Direction::Down => ("down strokes", Ink::SecondModel),
        };
        let times = || curve.time_s.iter().copied().map(milliseconds);
        let band = |(level, bounds): (f64, &CurveBounds)| {
            let name = format!("{stroke}: everywhere at once, {} %", percent(level));
            Band::between(name, ink, times(), &bounds.lower, &bounds.upper)
        };
        let level = found.bounds.map(|bounds| bounds.level);
        let bounds = level.zip(curve.bounds.as_ref());
        panel.bands.extend(bounds.map(band).into_valid());
        let points = times().zip(curve.percent.iter().copied());
        panel.curves.push(Curve::solid(stroke, ink, points));
    }
    let times = found.curves.first().map_or(&[][..], |curve| &curve.time_s);
    let ends = || {
        let ends = times.first().into_iter().chain(times.last());
        ends.copied().map(milliseconds)
    };
    let margin = found.margin_percent;
    for (level, name) in [
        (margin, format!("margin, {margin} %")),
        (-margin, String::new()),
    ] {
        let line = ends().map(|t| (t, level));
        panel.curves.push(Curve::dashed(name, Ink::Reference, line));
    }
    Figure::new(name, title, vec![panel])
}
