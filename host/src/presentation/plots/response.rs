//! Responses of models: to a step, and to sines.

use super::figure::{Band, Curve, Figure, Legend, Panel};
use crate::presentation::plots::paper_figures::{INKS, Named, with_unit};
use crate::presentation::summary::{Units, level_text};
use servoid_identification::frequency_response::FrequencyResponse;

/// What the legend calls the response of a model whose errors are not noise.
fn without_bounds(name: &str) -> String {
    format!("{name}: no bounds can be given")
}

/// Figs 5 and 10: the step response, with its bounds where they can be given.
#[must_use]
pub fn step_response(name: &str, title: &str, models: &[Named<'_>], units: Units<'_>) -> Figure {
    let mut panel = Panel {
        x_label: "time since the edge of the command (s)".into(),
        y_label: with_unit("response to a unit step", units.gain().as_deref()),
        ..Panel::default()
    };
    for (Named { name, model }, ink) in models.iter().zip(INKS) {
        let step = &model.step;
        let timing = model.timing();
        let line = |values: &[f64]| -> Vec<(f64, f64)> {
            let place = |(m, &value)| (timing.seconds(m as f64), value);
            values.iter().enumerate().map(place).collect()
        };
        if !model.bounds_hold() {
            let name = without_bounds(name);
            panel
                .curves
                .push(Curve::solid(name, ink, line(&step.value)));
            continue;
        }
        let level = level_text(model);
        let bounds = line(&step.simultaneous.lower)
            .into_iter()
            .zip(&step.simultaneous.upper);
        panel.bands.push(Band {
            name: format!("{name}: the whole curve, {level}"),
            ink,
            points: bounds
                .map(|((t, lower), &upper)| (t, lower, upper))
                .collect(),
        });
        panel
            .curves
            .push(Curve::solid(*name, ink, line(&step.value)));
        let each = format!("{name}: each point, {level}");
        panel
            .curves
            .push(Curve::dashed(each, ink, line(&step.pointwise.lower)));
        panel.curves.push(Curve {
            name: String::new(),
            ..Curve::dashed("", ink, line(&step.pointwise.upper))
        });
    }
    Figure {
        name: name.into(),
        title: title.into(),
        panels: vec![panel],
    }
}

/// Figs 6 and 11: magnitude and phase of the servo, freed of the hold and the phase of the samples, with
/// their bounds where they can be given.
#[must_use]
pub fn bode(name: &str, title: &str, models: &[Named<'_>]) -> Figure {
    let panel = |y_label: &str| Panel {
        x_label: "frequency (rad/s)".into(),
        x_logarithmic: true,
        y_label: y_label.into(),
        legend: Legend::UpperRight,
        ..Panel::default()
    };
    let (mut magnitude, mut phase) = (panel("magnitude (dB)"), panel("phase (deg)"));
    for (Named { name, model }, ink) in models.iter().zip(INKS) {
        // Only a model made by hand can have no response of its own; its samples' is at hand then.
        let own = model.servo_response(&model.frequency.omega_rad_s);
        let f = &own.unwrap_or_else(|_| model.frequency.clone());
        let shown = shown_frequencies(f);
        let level = format!("{name}: {}", level_text(model));
        let points = |values: &[f64]| {
            let points = f.omega_rad_s.iter().copied().zip(values.iter().copied());
            points
                .skip(shown.start)
                .take(shown.len())
                .collect::<Vec<_>>()
        };
        let band = |lower: &[f64], upper: &[f64]| {
            let bounds = points(lower).into_iter().zip(points(upper));
            let points = bounds
                .map(|((w, lower), (_, upper))| (w, lower, upper))
                .collect();
            Band {
                name: level.clone(),
                ink,
                points,
            }
        };
        let named = match model.bounds_hold() {
            true => (*name).to_owned(),
            false => without_bounds(name),
        };
        let curve = |values: &[f64]| Curve::solid(&named, ink, points(values));
        magnitude.curves.push(curve(&f.magnitude_db));
        phase.curves.push(curve(&f.phase_deg));
        if model.bounds_hold() {
            let lower = floored(f);
            magnitude.bands.push(band(&lower, &f.magnitude_db_upper));
            phase
                .bands
                .push(band(&f.phase_deg_lower, &f.phase_deg_upper));
        }
    }
    Figure {
        name: name.into(),
        title: title.into(),
        panels: vec![magnitude, phase],
    }
}

/// The lower bounds of the magnitude, no lower than a little below the lowest point of the curve:
/// where zero is possible, minus infinity would flatten everything else.
fn floored(response: &FrequencyResponse) -> Vec<f64> {
    let shown = response.magnitude_db.get(shown_frequencies(response));
    let floor = shown
        .unwrap_or_default()
        .iter()
        .copied()
        .fold(0.0, f64::min)
        - 10.0;
    response
        .magnitude_db_lower
        .iter()
        .map(|&lower| lower.max(floor))
        .collect()
}

/// The frequencies that can be drawn and mean something: above 0, which has no place on a
/// logarithmic axis, and below the first one where the response cannot be told from zero and any
/// phase is possible.
fn shown_frequencies(response: &FrequencyResponse) -> std::ops::Range<usize> {
    let start = response
        .omega_rad_s
        .iter()
        .take_while(|&&w| w <= 0.0)
        .count();
    let margins = response
        .phase_deg_upper
        .iter()
        .zip(&response.phase_deg_lower);
    let known = margins
        .skip(start)
        .take_while(|(upper, lower)| *upper - *lower < 360.0)
        .count();
    start..start + known
}
