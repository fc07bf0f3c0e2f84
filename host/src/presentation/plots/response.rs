//! Responses of models: to a step, and to sines.

use super::figure::{
    Band, Curve, Figure, INKS, Legend, Named, PHASE_LABEL, Panel, SINCE_EDGE_LABEL, milliseconds,
    with_unit,
};
use crate::data::units::Units;
use crate::presentation::summary::percent;
use servoid_identification::results::{Bounds, FrequencyResponse, Model};
use std::f64::consts::TAU;

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
    let mut panel = step_panel(models, units);
    for (Named { name, model }, ink) in models.iter().zip(INKS) {
        let Bounds::Valid(bounds) = &model.step.bounds else {
            continue;
        };
        let each = &bounds.pointwise;
        let line = |values: &[f64]| step_times(model).zip(values.to_vec());
        let point = format!("{name}: each point, {} %", percent(bounds.level));
        panel.curves.extend([
            Curve::dashed(point, ink, line(&each.lower)),
            Curve::dashed("", ink, line(&each.upper)),
        ]);
    }
    Figure::new(name, title, vec![panel])
}

/// Sample times of a step response, for its axis.
fn step_times(model: &Model) -> impl Iterator<Item = f64> + use<> {
    let timing = model.timing();
    (0..).map(move |m| milliseconds(timing.seconds(f64::from(m))))
}

/// Step responses, each with the bounds of the whole curve where they hold.
pub(super) fn step_panel(models: &[Named<'_>], units: Units<'_>) -> Panel {
    let y_label = with_unit("response to a unit step", units.gain().as_deref());
    let mut panel = Panel::new(SINCE_EDGE_LABEL, y_label, Legend::LowerRight);
    for (Named { name, model }, ink) in models.iter().zip(INKS) {
        let (step, times) = (&model.step, || step_times(model));
        let line = |values: &[f64]| times().zip(values.to_vec());
        let legend = in_legend(name, &step.bounds);
        panel
            .curves
            .push(Curve::solid(legend, ink, line(&step.value)));
        let Bounds::Valid(bounds) = &step.bounds else {
            continue;
        };
        let whole = &bounds.simultaneous;
        // Another motion of a servo that is not linear may be farther off.
        let motion = if model.linear { "" } else { ", of this motion" };
        let band = format!(
            "{name}: the whole curve, {} %{motion}",
            percent(bounds.level)
        );
        panel.bands.push(Band::between(
            band,
            ink,
            times(),
            &whole.lower,
            &whole.upper,
        ));
    }
    panel
}

/// Figs 6 and 11: magnitude and phase of the servo, freed of the hold and the phase of the samples, with
/// their bounds where they hold.
#[must_use]
pub fn bode(name: &str, title: &str, models: &[Named<'_>]) -> Figure {
    let panel = |y_label: &str| Panel {
        x_logarithmic: true,
        ..Panel::new("frequency (Hz)", y_label, Legend::UpperRight)
    };
    let (mut magnitude, mut phase) = (panel("magnitude (dB)"), panel(PHASE_LABEL));
    for (Named { name, model }, ink) in models.iter().zip(INKS) {
        let f = &servo_frequency(model);
        let shown = shown_frequencies(f);
        let part = |values: &[f64]| values.get(shown.clone()).unwrap_or_default().to_vec();
        let hertz: Vec<f64> = part(&f.omega_rad_s).iter().map(|w| w / TAU).collect();
        let legend = in_legend(name, &f.bounds);
        let curve =
            |values: &[f64]| Curve::solid(&legend, ink, hertz.iter().copied().zip(part(values)));
        magnitude.curves.push(curve(&f.magnitude_db));
        phase.curves.push(curve(&f.phase_deg));
        let Bounds::Valid(bounds) = &f.bounds else {
            continue;
        };
        let band = |lower: &[f64], upper: &[f64]| {
            let name = format!("{name}: {} %", percent(bounds.level));
            Band::between(name, ink, hertz.clone(), &part(lower), &part(upper))
        };
        // Where zero is possible, minus infinity would flatten everything else.
        let floor = part(&f.magnitude_db).into_iter().fold(0.0, f64::min) - 10.0;
        let lower: Vec<f64> = bounds
            .magnitude_db_lower
            .iter()
            .map(|db| db.max(floor))
            .collect();
        magnitude
            .bands
            .push(band(&lower, &bounds.magnitude_db_upper));
        phase
            .bands
            .push(band(&bounds.phase_deg_lower, &bounds.phase_deg_upper));
    }
    Figure::new(name, title, vec![magnitude, phase])
}

/// The frequency response of the servo, freed of the hold and the phase of the samples, at the frequencies of the model.
#[must_use]
pub fn servo_frequency(model: &Model) -> FrequencyResponse {
    // Only a model made by hand can have no response of its own; that of its samples is shown then.
    let own = model.servo_response(&model.frequency.omega_rad_s);
    own.unwrap_or_else(|_| model.frequency.clone())
}

/// The frequencies that can be drawn and mean something: above 0, which has no place on a
/// logarithmic axis, and below the first one where zero is within the bounds and any phase is possible.
#[must_use]
pub fn shown_frequencies(response: &FrequencyResponse) -> std::ops::Range<usize> {
    let omega = &response.omega_rad_s;
    let start = omega.iter().take_while(|&&w| w <= 0.0).count();
    let known = match &response.bounds {
        Bounds::Valid(bounds) => {
            let widths = bounds.phase_deg_upper.iter().zip(&bounds.phase_deg_lower);
            let known = widths
                .skip(start)
                .take_while(|(upper, lower)| *upper - *lower < 360.0);
            known.count()
        }
        Bounds::Withdrawn(_) => omega.len() - start,
    };
    start..start + known
}
