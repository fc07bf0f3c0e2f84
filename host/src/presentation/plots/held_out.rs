//! A stretch that the models have not seen: measurement, linear model and servo model, with the residuals below.

use super::figure::{Figure, Ink, with_unit};
use super::signals::{over_time, signal};
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
    let drawn = |name: &str, ink: Ink, values: &[f64]| signal(name, ink, found.period_s, values);
    let [linear_fit, servo_fit] = found.fits_percent;
    let models = [
        ("linear model", linear_fit, Ink::Model, &found.by_linear),
        ("servo model", servo_fit, Ink::SecondModel, &found.by_servo),
    ];
    let mut above = vec![drawn("measured", Ink::Measured, &found.measured)];
    let mut below = Vec::new();
    for (name, fit, ink, predicted) in models {
        above.push(drawn(&format!("{name}, fit {fit:.1} %"), ink, predicted));
        let residual: Vec<f64> = found
            .measured
            .iter()
            .zip(predicted)
            .map(|(y, predicted)| y - predicted)
            .collect();
        below.push(drawn(name, ink, &residual));
    }
    let panels = vec![
        over_time(with_unit("position", unit), above),
        over_time(with_unit("measured - model", unit), below),
    ];
    Figure::new(name, title, panels)
}
