//! Whether errors are slow: alike over several strokes, as those of a sensor that drifts are.
//!
//! What a servo does otherwise than the model changes with each stroke, so its mean over four strokes has about a quarter of the square that it has in one.
//! A drift has as much.

use crate::data::{Record, usual_hold};
use crate::diagnostics::misfit::followed_after;
use crate::numerics::square_about_mean;
use crate::results::Model;
use crate::thresholds::SLOW_ERRORS;

/// Strokes of which the errors are averaged, and the stretches of so many that are needed.
const STROKES: usize = 4;
const STRETCHES: usize = 8;

/// Errors that are slow.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct SlowErrors {
    /// Share of their square that the means over several strokes have.
    pub(crate) share: f64,
    /// The time of these strokes \[s\].
    pub(crate) seconds: f64,
}

impl SlowErrors {
    /// Of the simulation of `record` by `model`; `None` where the errors are not slow.
    pub(crate) fn of(record: &Record, model: &Model) -> Option<Self> {
        let stroke = usual_hold(record).max(followed_after(&model.step.value));
        let length = STROKES * stroke;
        let (mut means, mut errors) = (Vec::new(), Vec::new());
        for run in record.runs() {
            let simulated = model.simulate(run);
            let of_run = run.output().iter().zip(&simulated).map(|(y, s)| y - s);
            let of_run: Vec<f64> = of_run.filter(|error| !error.is_nan()).collect();
            for stretch in of_run.chunks_exact(length.max(1)) {
                means.push(stretch.iter().sum::<f64>() / length as f64);
                errors.extend_from_slice(stretch);
            }
        }
        if means.len() < STRETCHES {
            return None;
        }
        let share = square_about_mean(&means) * length as f64 / square_about_mean(&errors);
        (share > SLOW_ERRORS).then_some(Self {
            share,
            seconds: length as f64 * record.sample_period_s(),
        })
    }

    /// What may be the cause, as a sentence.
    pub(super) fn in_words(self) -> String {
        format!(
            "The errors are slow: the means over {:.1} s, of {STROKES} strokes, have {:.0} % of their square, so a sensor, a supply or a load that drifts is more \
             likely than a servo that is not linear",
            self.seconds,
            100.0 * self.share
        )
    }
}
