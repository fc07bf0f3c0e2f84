//! A plan as a plot.

use super::band_width::BandWidths;
use super::forecast::Plan;
use super::spectrum::Density;
use crate::presentation::plots::figure::{Band, Curve, Figure, Ink, Legend, Panel};
use crate::presentation::summary;
use servoid_identification::results::StepBounds;

/// The spectrum beside the noise, and the step response with the expected band, if there is one.
#[must_use]
pub fn figure(plan: &Plan, name: &str) -> Figure {
    let curve = |label: &str, ink, of: fn(&Density) -> f64| {
        Curve::solid(
            label,
            ink,
            plan.spectrum.lines.iter().map(|line| (line.hz, of(line))),
        )
    };
    let noise = Curve {
        dashed: true,
        ..curve("noise", Ink::Model, |line| line.noise_db)
    };
    let spectrum = Panel {
        x_label: "frequency (Hz)".into(),
        x_logarithmic: true,
        y_label: "density (dB over 1 deg²/Hz)".into(),
        legend: Legend::Above,
        curves: vec![
            curve("reference", Ink::Reference, |line| line.reference_db),
            curve("the servo's response", Ink::Measured, |line| {
                line.response_db
            }),
            noise,
        ],
        ..Panel::default()
    };
    let step = &plan.step;
    let times = || step.time_s.iter().copied();
    let band = |(widths, bounds): (BandWidths, &StepBounds)| {
        let whole = &bounds.simultaneous;
        let bounds = whole.lower.iter().zip(&whole.upper);
        Band {
            name: format!(
                "expected, the whole curve, {} %",
                summary::percent(widths.level)
            ),
            ink: Ink::Model,
            points: times()
                .zip(bounds)
                .map(|(t, (&lower, &upper))| (t, lower, upper))
                .collect(),
        }
    };
    let expected = plan.band.zip(step.bounds.valid());
    let response = Panel {
        x_label: "time since the edge of the command (s)".into(),
        y_label: "response to a unit step".into(),
        bands: expected.map(band).into_iter().collect(),
        curves: vec![Curve::solid(
            plan.servo.as_str(),
            Ink::Model,
            times().zip(step.value.iter().copied()),
        )],
        ..Panel::default()
    };
    Figure {
        name: name.into(),
        title: plan.description.clone(),
        panels: vec![spectrum, response],
    }
}
