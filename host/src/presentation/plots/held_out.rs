//! A stretch that the models have not seen: measurement, linear model and servo model, with the residuals below.

use super::figure::{Figure, Ink, with_unit};
use super::signals::{over_time, signal};

/// A stretch of a record, and what two models predict of it that were identified without it.
#[derive(Clone, Debug, PartialEq)]
pub struct HeldOutPrediction {
    /// What part of the record it is, in words.
    pub stretch: &'static str,
    /// Sample period \[s\].
    pub period_s: f64,
    /// Fit of the linear model and of the servo model, on the samples that both predict \[%\].
    pub fits_percent: [f64; 2],
    /// The measured output, sample by sample.
    pub measured: Vec<f64>,
    /// The output of the linear model; NaN where its history is not complete.
    pub by_linear: Vec<f64>,
    /// The output of the servo model.
    pub by_servo: Vec<f64>,
}

impl HeldOutPrediction {
    /// A sentence below its figure.
    #[must_use]
    pub fn caption(&self) -> String {
        format!(
            "This is {} of the recording. Both models in this figure were identified without it, and simulate it from the reference and the first sample of its run; below, the residuals.",
            self.stretch
        )
    }
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
