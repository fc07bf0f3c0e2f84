//! Responses of models: to a step, and to sines.

use super::figure::{Band, Curve, Figure, Legend, Panel};
use super::named::{INKS, Named, with_unit};
use crate::data::units::Units;
use crate::presentation::summary::percent;
use servoid_identification::results::{Bounds, FrequencyResponse};

/// The name of a response in a legend.
fn in_legend<T>(name: &str, bounds: &Bounds<T>) -> String {
    match bounds {
        Bounds::Valid(_) => name.to_owned(),
        Bounds::Withdrawn(_) => format!("{name}: no bounds can be given"),
    }
}

/// Figs 5 and 10: the step response, with its bounds where they hold.
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
        let legend = in_legend(name, &step.bounds);
        panel
            .curves
            .push(Curve::solid(legend, ink, line(&step.value)));
        let Bounds::Valid(bounds) = &step.bounds else {
            continue;
        };
        let (each, whole) = (&bounds.pointwise, &bounds.simultaneous);
        let level = percent(bounds.level);
        panel.bands.push(Band {
            name: format!("{name}: the whole curve, {level} %"),
            ink,
            points: line(&whole.lower)
                .into_iter()
                .zip(&whole.upper)
                .map(|((t, lower), &upper)| (t, lower, upper))
                .collect(),
        });
        let point = format!("{name}: each point, {level} %");
        panel.curves.extend([
            Curve::dashed(point, ink, line(&each.lower)),
            Curve::dashed("", ink, line(&each.upper)),
        ]);
    }
    Figure {
        name: name.into(),
        title: title.into(),
        panels: vec![panel],
    }
}

/// Figs 6 and 11: magnitude and phase of the servo, freed of the hold and the phase of the samples, with
/// their bounds where they hold.
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
        let points = |values: &[f64]| {
            let points = f.omega_rad_s.iter().copied().zip(values.iter().copied());
            points
                .skip(shown.start)
                .take(shown.len())
                .collect::<Vec<_>>()
        };
        let legend = in_legend(name, &f.bounds);
        let curve = |values: &[f64]| Curve::solid(&legend, ink, points(values));
        magnitude.curves.push(curve(&f.magnitude_db));
        phase.curves.push(curve(&f.phase_deg));
        let Bounds::Valid(bounds) = &f.bounds else {
            continue;
        };
        let band = |lower: &[f64], upper: &[f64]| Band {
            name: format!("{name}: {} %", percent(bounds.level)),
            ink,
            points: points(lower)
                .into_iter()
                .zip(points(upper))
                .map(|((w, lower), (_, upper))| (w, lower, upper))
                .collect(),
        };
        let lower = floored(&bounds.magnitude_db_lower, &f.magnitude_db, &shown);
        magnitude
            .bands
            .push(band(&lower, &bounds.magnitude_db_upper));
        phase
            .bands
            .push(band(&bounds.phase_deg_lower, &bounds.phase_deg_upper));
    }
    Figure {
        name: name.into(),
        title: title.into(),
        panels: vec![magnitude, phase],
    }
}

/// The lower bounds of the magnitude, no lower than a little below the lowest point of the curve as `shown`:
/// where zero is possible, minus infinity would flatten everything else.
fn floored(lower: &[f64], magnitude_db: &[f64], shown: &std::ops::Range<usize>) -> Vec<f64> {
    let shown = magnitude_db.get(shown.clone()).unwrap_or_default();
    let floor = shown.iter().copied().fold(0.0, f64::min) - 10.0;
    lower.iter().map(|&lower| lower.max(floor)).collect()
}

/// The frequencies that can be drawn and mean something: above 0, which has no place on a
/// logarithmic axis, and below the first one where zero is within the bounds and any phase is possible.
fn shown_frequencies(response: &FrequencyResponse) -> std::ops::Range<usize> {
    let start = response
        .omega_rad_s
        .iter()
        .take_while(|&&w| w <= 0.0)
        .count();
    let known = match &response.bounds {
        Bounds::Valid(bounds) => bounds
            .phase_deg_upper
            .iter()
            .zip(&bounds.phase_deg_lower)
            .skip(start)
            .take_while(|(upper, lower)| *upper - *lower < 360.0)
            .count(),
        Bounds::Withdrawn(_) => response.omega_rad_s.len() - start,
    };
    start..start + known
}
