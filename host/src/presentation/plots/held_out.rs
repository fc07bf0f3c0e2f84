//! A stretch that the models have not seen: measurement, linear model and servo model, with the residuals below.

use super::figure::{Figure, Ink};
use super::signals::against_measurement;
use crate::data::HeldOutPrediction;

/// The sentence below the figure.
#[must_use]
pub fn held_out_caption(found: &HeldOutPrediction) -> String {
    format!(
        "This is {} of the recording. Both models in this figure were identified without it, and simulate it from the reference and the first sample of its run; below, the residuals.",
        found.stretch
    )
}

/// Measurement and predictions, and the residuals below; `unit` is that of the output.
#[must_use]
pub fn held_out(name: &str, title: &str, found: &HeldOutPrediction, unit: Option<&str>) -> Figure {
    let named = |name: &str, fit: f64| format!("{name}, fit {fit:.1} %");
    let [linear_fit, servo_fit] = found.fits_percent;
    let linear = named("linear model", linear_fit);
    let servo = named("servo model", servo_fit);
    let models = [
        (linear.as_str(), Ink::Model, found.by_linear.as_slice()),
        (servo.as_str(), Ink::SecondModel, found.by_servo.as_slice()),
    ];
    let panels = against_measurement((found.period_s, &found.measured), &models, unit);
    Figure::new(name, title, panels)
}
