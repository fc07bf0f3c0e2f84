//! Signals over time: what was commanded and measured, and what models make of it.

use super::figure::{Curve, Figure, Ink, Legend, Panel};
use super::named::{INKS, Named, with_unit};
use crate::data::units::Units;
use servoid_identification::{Record, Run};

/// Points of a long record that are still drawn one by one.
const MOST_POINTS: usize = 6_000;

/// A signal over time. Of a long one, each stretch of samples is drawn as its smallest and its
/// largest value: at the width of a page that looks the same, and the file stays small.
fn signal(period_s: f64, values: &[f64]) -> Vec<(f64, f64)> {
    let time = |k: usize| k as f64 * period_s;
    if values.len() <= MOST_POINTS {
        return values
            .iter()
            .enumerate()
            .map(|(k, &value)| (time(k), value))
            .collect();
    }
    let stretch = (2 * values.len()).div_ceil(MOST_POINTS);
    let extremes = |(index, part): (usize, &[f64])| {
        let placed = || (index * stretch..).map(time).zip(part.iter().copied());
        let low = placed().min_by(|a, b| a.1.total_cmp(&b.1))?;
        // A missing sample (NaN) counts as the largest, so that gaps stay visible.
        let high = placed().max_by(|a, b| a.1.total_cmp(&b.1))?;
        Some(if low.0 <= high.0 {
            [low, high]
        } else {
            [high, low]
        })
    };
    values
        .chunks(stretch)
        .enumerate()
        .filter_map(extremes)
        .flatten()
        .collect()
}

/// Runs of a record that are drawn; of more, these are the first.
pub const MOST_RUNS: usize = 3;

/// Figs 4 and 8: the reference and the measurement of each run, in one panel, or in two where one scale
/// does not serve both.
#[must_use]
pub fn input_output(name: &str, title: &str, record: &Record, units: Units<'_>) -> Figure {
    let period = record.sample_period_s();
    let panel = |y_label: String, curves: Vec<Curve>| Panel {
        x_label: "time (s)".into(),
        y_label,
        legend: Legend::Above,
        curves,
        ..Panel::default()
    };
    let panels = record.runs().iter().take(MOST_RUNS).flat_map(|run| {
        let measured = Curve::solid("measured", Ink::Measured, signal(period, run.output()));
        let reference = Curve::solid("reference", Ink::Reference, signal(period, run.input()));
        let position = with_unit("position", units.output);
        if share_a_scale(run, units) {
            return vec![panel(position, vec![measured, reference])];
        }
        vec![
            panel(with_unit("reference", units.input), vec![reference]),
            panel(position, vec![measured]),
        ]
    });
    Figure {
        name: name.into(),
        title: title.into(),
        panels: panels.collect(),
    }
}

/// A signal whose span is less than this part of what both take together would be drawn as a flat line.
const FLAT: f64 = 0.1;

/// Whether input and output can be read off one axis: they have one unit, as far as is known, and neither
/// is flat beside the other, as degrees are beside microseconds.
fn share_a_scale(run: &Run, units: Units<'_>) -> bool {
    let ends = |values: &[f64]| {
        let finite = || values.iter().copied().filter(|value| value.is_finite());
        [
            finite().fold(f64::INFINITY, f64::min),
            finite().fold(f64::NEG_INFINITY, f64::max),
        ]
    };
    let ([low, high], [bottom, top]) = (ends(run.input()), ends(run.output()));
    let both = high.max(top) - low.min(bottom);
    let differ = units.gain().is_some();
    !differ && high - low >= FLAT * both && top - bottom >= FLAT * both
}

/// Figs 7, 9 and 12: models against a measurement, with the residual below.
#[must_use]
pub fn validation(
    name: &str,
    title: &str,
    models: &[Named<'_>],
    run: &Run,
    unit: Option<&str>,
) -> Figure {
    let Some(first) = models.first() else {
        return Figure {
            name: name.into(),
            title: title.into(),
            panels: Vec::new(),
        };
    };
    let period = first.model.sample_period_s;
    let measured = run.output();
    let mut above = Panel {
        x_label: "time (s)".into(),
        y_label: with_unit("position", unit),
        legend: Legend::Above,
        curves: vec![Curve::solid(
            "measured",
            Ink::Measured,
            signal(period, measured),
        )],
        ..Panel::default()
    };
    let mut below = Panel {
        x_label: "time (s)".into(),
        y_label: with_unit("measured - model", unit),
        legend: Legend::Above,
        ..Panel::default()
    };
    for (Named { name, model }, ink) in models.iter().zip(INKS) {
        let simulated = model.simulate(run);
        let residual: Vec<f64> = measured
            .iter()
            .zip(&simulated)
            .map(|(y, s)| y - s)
            .collect();
        above
            .curves
            .push(Curve::solid(*name, ink, signal(period, &simulated)));
        below
            .curves
            .push(Curve::solid(*name, ink, signal(period, &residual)));
    }
    Figure {
        name: name.into(),
        title: title.into(),
        panels: vec![above, below],
    }
}
