//! Whether a model predicts its record: what it misses of the motion, beyond what is noise.
//!
//! A right model of a servo under much noise fits poorly, and a wrong one does so without noise. With e the errors, n the noise and y
//! the output, all rms and about the mean,
//!
//! ```text
//! predicted share of the motion = 1 - sqrt((e² - n²) / (y² - n²))
//! ```

use super::{LinearKind, ServoModel};
use crate::data::Record;
use crate::diagnostics::SlowErrors;
use crate::results::{Advice, Check, Model};
use crate::thresholds::{MOTION_IN_NOISE, POOR_PREDICTION_PERCENT};

/// A fit that noise may leave and go without mention \[%\].
const LITTLE_NOISE_PERCENT: f64 = 95.0;

impl ServoModel {
    /// How well it predicts \[%\]: the lesser of its fit to the whole record and to parts not seen. In the latter the largest
    /// errors count for less, so that a model which is lost there may seem the better for it. Beside linear models it is found and simulated again: one that
    /// predicts poorly there owes its fit to where it was begun.
    #[must_use]
    pub fn prediction_percent(&self) -> f64 {
        let fit = self.fit.simulation_percent.min(self.fit.held_out_percent);
        let beside = self.linear_models.as_ref();
        let again = beside.map(|found| found.servo_model_percent);
        again
            .filter(|percent| *percent < POOR_PREDICTION_PERCENT)
            .map_or(fit, |percent| fit.min(percent))
    }

    /// The fit of a model whose errors are noise alone \[%\]; `None` where noise matters little.
    #[must_use]
    pub fn reachable_percent(&self) -> Option<f64> {
        let percent = 100.0 * (1.0 - self.noise_share(self.prediction_percent()));
        (percent < LITTLE_NOISE_PERCENT).then_some(percent)
    }

    /// Whether it predicts its record as well as noise lets it, or nearly so.
    #[must_use]
    pub fn predicts(&self) -> bool {
        let fit = self.prediction_percent();
        motion_predicted(fit, self.noise_share(fit)) >= POOR_PREDICTION_PERCENT
    }

    /// Noise as a share of the output, rms: the errors themselves where intervals hold, because they were tested as noise then;
    /// elsewhere what of the errors is new in each sample.
    fn noise_share(&self, fit_percent: f64) -> f64 {
        let missed = 1.0 - fit_percent / 100.0;
        if self.covariance.valid().is_some() {
            return missed;
        }
        let of_simulation = 1.0 - self.fit.simulation_percent / 100.0;
        let share = of_simulation * self.noise.sigma / self.fit.rmse;
        // Errors of a model without errors are none, and have no share.
        if share.is_nan() {
            0.0
        } else {
            share.min(missed)
        }
    }

    /// How well the linear model beside it predicts \[%\], by the parts that both predict where these are most of the record.
    fn linear_percent(&self, linear: &Model) -> f64 {
        let whole = linear.fit.simulation_percent;
        let beside = self.linear_models.as_ref();
        let beside = beside.filter(|found| 2 * found.samples_used > self.fit.samples_used);
        let unseen = beside.and_then(|found| found.percent_of(LinearKind::Linear));
        unseen.map_or(whole, |percent| whole.min(percent))
    }
}

/// The share of the motion that a fit predicts under noise of this share of the output, rms \[%\].
fn motion_predicted(fit_percent: f64, noise: f64) -> f64 {
    let missed = 1.0 - fit_percent / 100.0;
    let motion = 1.0 - noise * noise;
    if motion < MOTION_IN_NOISE {
        return 0.0;
    }
    100.0 * (1.0 - ((missed * missed - noise * noise).max(0.0) / motion).sqrt())
}

const CHECK_THE_COLUMNS: &str = "Check that the input is the command of this servo and the output its motion, that the time between samples is right, that \
                                 no controller computes the input from the output, and that nothing else moves the servo or changes between the runs.";

/// That neither model of a `record` predicts it. The bounds of a linear model rest on errors that were tested as noise.
#[must_use]
pub fn no_prediction(record: &Record, linear: &Model, servo: &ServoModel) -> Option<Advice> {
    let (of_linear, of_servo) = (servo.linear_percent(linear), servo.prediction_percent());
    let noise = match linear.bounds.valid() {
        Some(_) => 1.0 - of_linear / 100.0,
        None => servo.noise_share(of_linear),
    };
    if servo.predicts() || motion_predicted(of_linear, noise) >= POOR_PREDICTION_PERCENT {
        return None;
    }
    let reachable = servo.reachable_percent();
    let noise = reachable.map(|percent| format!(", where noise alone would leave {percent:.0} %"));
    let noise = noise.unwrap_or_default();
    Some(Advice::new(
        Check::Prediction,
        format!(
            "Neither the linear model nor the servo model predicts this recording: simulated from the input, they fit what they had \
             not seen to {:.0} and {:.0} %{noise}. What they say of the servo is not to be relied on.",
            of_linear.max(0.0),
            of_servo.max(0.0)
        ),
        of_linear.max(of_servo),
        POOR_PREDICTION_PERCENT,
        SlowErrors::of(record, linear).map_or_else(
            || CHECK_THE_COLUMNS.to_owned(),
            |slow| {
                let without_line = linear.advice.iter().any(Advice::is_of_drift);
                format!("{}. {}.", slow.in_words(), SlowErrors::remedy(without_line))
            },
        ),
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_poor_fit_is_a_poor_prediction_only_beyond_the_noise() {
        // Noise as large as the motion: y² = 2, e² = n² = 1.
        let noise = 0.5f64.sqrt();
        let fit = 100.0 * (1.0 - noise);
        assert!(motion_predicted(fit, noise) > 99.9);
        assert!((motion_predicted(fit, 0.0) - fit).abs() < 1e-9);
        // Beside that noise, half of the motion is missed: e² = 1 + 0.25.
        let half = 100.0 * (1.0 - (1.25f64 / 2.0).sqrt());
        assert!((motion_predicted(half, noise) - 50.0).abs() < 1e-9);
        // Noise alone.
        assert_eq!(motion_predicted(2.0, 0.98), 0.0);
    }
}
