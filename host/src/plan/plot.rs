//! A plan as a plot.

use super::band_width::BandWidths;
use super::forecast::Plan;
use super::spectrum::Density;
use crate::presentation::plots::{
    Band, Curve, Figure, Ink, Legend, Panel, SINCE_EDGE_LABEL, milliseconds,
};
use crate::presentation::summary;
use servoid_identification::results::StepBounds;

/// The spectrum beside the noise, and the step response with the expected band, if there is one.
#[must_use]
pub fn figure(plan: &Plan, name: &str) -> Figure {
    let lines = || plan.spectrum.lines.iter();
    let points = |of: fn(&Density) -> f64| lines().map(move |line| (line.hz, of(line)));
    let [reference, response, noise] = [
        points(|line| line.reference_db),
        points(|line| line.response_db),
        points(|line| line.noise_db),
    ];
    let spectrum = Panel {
        x_logarithmic: true,
        curves: vec![
            Curve::solid("reference", Ink::Reference, reference),
            Curve::solid("the servo's response", Ink::Measured, response),
            Curve::dashed("noise", Ink::Model, noise),
        ],
        ..Panel::new(
            "frequency (Hz)",
            "density (dB over 1 deg²/Hz)",
            Legend::Above,
        )
    };
    let step = &plan.step;
    let times = || step.time_s.iter().copied().map(milliseconds);
    let band = |(widths, bounds): (&BandWidths, &StepBounds)| {
        let whole = &bounds.simultaneous;
        let name = format!(
            "expected, the whole curve, {} %",
            summary::percent(widths.level)
        );
        Band::between(name, Ink::Model, times(), &whole.lower, &whole.upper)
    };
    let expected = plan.band.valid().zip(step.bounds.valid());
    let value = times().zip(step.value.iter().copied());
    let response = Panel {
        bands: expected.map(band).into_iter().collect(),
        curves: vec![Curve::solid(plan.servo.as_str(), Ink::Model, value)],
        ..Panel::new(
            SINCE_EDGE_LABEL,
            "response to a unit step",
            Legend::LowerRight,
        )
    };
    Figure::new(name, &plan.description, vec![spectrum, response])
}
