//! The difference of two servos: the second step response less the first, with bounds and margin.

use super::figure::{Band, Curve, Figure, Ink, Legend, Panel};
use crate::presentation::summary::percent;
use servoid_identification::comparison::{Comparison, CurveBounds, Stroke};

/// The difference curves of a comparison of `a` with `b`, within bounds that hold for all of them at
/// once. The verdict is "different" where a band lies outside the margin somewhere, "same" where all
/// lie inside it everywhere.
#[must_use]
pub fn difference(name: &str, title: &str, a: &str, b: &str, found: &Comparison) -> Figure {
    let mut panel = Panel {
        x_label: "time since the edge of the command (s)".into(),
        y_label: format!("{b} - {a} (% of the step)"),
        legend: Legend::Above,
        ..Panel::default()
    };
    for curve in &found.curves {
        let (stroke, ink) = match curve.stroke {
            Stroke::Both => ("difference", Ink::Model),
            Stroke::Up => ("up strokes", Ink::Model),
            Stroke::Down => ("down strokes", Ink::SecondModel),
        };
        let band = |(level, bounds): (f64, &CurveBounds)| Band {
            name: format!("{stroke}: everywhere at once, {} %", percent(level)),
            ink,
            points: curve
                .time_s
                .iter()
                .zip(bounds.lower.iter().zip(&bounds.upper))
                .map(|(&t, (&low, &high))| (t, low, high))
                .collect(),
        };
        let level = found.bounds.map(|bounds| bounds.level);
        let bounds = level.zip(curve.bounds.as_ref());
        panel.bands.extend(bounds.map(band).into_valid());
        let points = curve
            .time_s
            .iter()
            .copied()
            .zip(curve.percent.iter().copied());
        panel.curves.push(Curve::solid(stroke, ink, points));
    }
    let times = found.curves.first().map(|curve| &curve.time_s);
    let ends: Vec<f64> = times
        .iter()
        .flat_map(|times| [times.first(), times.last()])
        .flatten()
        .copied()
        .collect();
    for (sign, name) in [
        (1.0, format!("margin, {} %", found.margin_percent)),
        (-1.0, String::new()),
    ] {
        let line = ends.iter().map(|&t| (t, sign * found.margin_percent));
        panel.curves.push(Curve::dashed(name, Ink::Reference, line));
    }
    Figure {
        name: name.into(),
        title: title.into(),
        panels: vec![panel],
    }
}
