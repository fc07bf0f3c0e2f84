//! Signals over time: command, measurement and simulation.

use super::figure::{Curve, Figure, INKS, Ink, Legend, Named, Panel, with_unit};
use crate::data::PredictedRun;
use crate::data::units::Units;
use servoid_identification::{Record, Run};

/// Points of a long record that are still drawn one by one.
const MOST_POINTS: usize = 6_000;

/// A signal over time. Of a long one, each stretch of samples is drawn as its smallest and its
/// largest value: at the width of a page that looks the same, and the file stays small.
pub(super) fn signal(name: &str, ink: Ink, period_s: f64, values: &[f64]) -> Curve {
    let time = |k: usize| k as f64 * period_s;
    if values.len() <= MOST_POINTS {
        return Curve::solid(name, ink, (0..).map(time).zip(values.iter().copied()));
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
    let stretches = values.chunks(stretch).enumerate();
    Curve::solid(name, ink, stretches.filter_map(extremes).flatten())
}

/// Runs of a record that are drawn; of more, these are the first.
pub(crate) const MOST_RUNS: usize = 3;

/// Axes over time.
pub(super) fn over_time(y_label: String, curves: Vec<Curve>) -> Panel {
    Panel {
        curves,
        ..Panel::new("time (s)", y_label, Legend::Above)
    }
}

/// Figs 4 and 8: the reference and the measurement of each run, in one panel, or in two where one scale
/// does not serve both.
#[must_use]
pub fn input_output(name: &str, title: &str, record: &Record, units: Units<'_>) -> Figure {
    let period = record.sample_period_s();
    let panels = record.runs().iter().take(MOST_RUNS).flat_map(|run| {
        let measured = signal("measured", Ink::Measured, period, run.output());
        let reference = signal("reference", Ink::Reference, period, run.input());
        let position = with_unit("position", units.output);
        if share_a_scale(run, units) {
            return vec![over_time(position, vec![measured, reference])];
        }
        vec![
            over_time(with_unit("reference", units.input), vec![reference]),
            over_time(position, vec![measured]),
        ]
    });
    Figure::new(name, title, panels.collect())
}

/// A signal whose span is less than this part of what both take together would be drawn as a flat line.
const FLAT: f64 = 0.1;

/// Whether input and output can be read off one axis: they have one unit, as far as is known, and neither
/// is flat beside the other, as degrees are beside microseconds.
fn share_a_scale(run: &Run, units: Units<'_>) -> bool {
    let ends = |values: &[f64]| {
        let finite = values.iter().filter(|value| value.is_finite());
        finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &value| {
            (low.min(value), high.max(value))
        })
    };
    let ((low, high), (bottom, top)) = (ends(run.input()), ends(run.output()));
    let both = high.max(top) - low.min(bottom);
    let differ = units.gain().is_some();
    !differ && high - low >= FLAT * both && top - bottom >= FLAT * both
}

/// A curve of a model: its name, colour and output.
pub(super) type ModelCurve<'a> = (&'a str, Ink, &'a [f64]);

/// What was measured and what models predict, with the residuals below.
pub(super) fn against_measurement(
    (period_s, measured): (f64, &[f64]),
    models: &[ModelCurve<'_>],
    unit: Option<&str>,
) -> Vec<Panel> {
    let mut above = vec![signal("measured", Ink::Measured, period_s, measured)];
    let mut below = Vec::new();
    for (name, ink, predicted) in models {
        let residual = measured.iter().zip(*predicted).map(|(y, by)| y - by);
        let residual: Vec<f64> = residual.collect();
        above.push(signal(name, *ink, period_s, predicted));
        below.push(signal(name, *ink, period_s, &residual));
    }
    vec![
        over_time(with_unit("position", unit), above),
        over_time(with_unit("measured - model", unit), below),
    ]
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
        return Figure::new(name, title, Vec::new());
    };
    let simulated: Vec<Vec<f64>> = models
        .iter()
        .map(|named| named.model.simulate(run))
        .collect();
    let curves = models.iter().zip(INKS).zip(&simulated);
    let curves: Vec<ModelCurve> = curves
        .map(|((named, ink), simulated)| (named.name, ink, simulated.as_slice()))
        .collect();
    let measured = (first.model.sample_period_s, run.output());
    Figure::new(name, title, against_measurement(measured, &curves, unit))
}

/// What the models of a file predict of a run, against what was measured, with the residuals below.
#[must_use]
pub fn predicted(name: &str, title: &str, run: &PredictedRun, unit: Option<&str>) -> Figure {
    let linear = (run.by_linear.as_deref()).map(|by| ("linear model", Ink::Model, by));
    let servo = (run.by_servo.as_deref()).map(|by| ("servo model", Ink::SecondModel, by));
    let curves: Vec<ModelCurve> = linear.into_iter().chain(servo).collect();
    let measured = (run.period_s, run.measured.as_slice());
    Figure::new(name, title, against_measurement(measured, &curves, unit))
}
