//! Whether errors are slow: alike over several strokes, as those of a sensor that drifts are.
//!
//! What a servo does otherwise than the model changes with each stroke, so its mean over four strokes has about a quarter of the square that it has in one.
//! A drift has as much.

use super::followed_after;
use crate::data::{Record, usual_hold};
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

    /// What to record then: strokes that are as large, and rests beside which the drift is seen. `without_line` where a straight line of each run is
    /// taken out already.
    pub(crate) fn remedy(without_line: bool) -> &'static str {
        match without_line {
            true => {
                "Look for the drift, and record the same steps with each held several times as long"
            }
            false => {
                "Look for the drift, of which '--detrend linear' takes out a straight line in each run, and record the same steps with each held \
                 several times as long"
            }
        }
    }

    /// The time of one stroke \[s\].
    pub(crate) fn stroke_s(self) -> f64 {
        self.seconds / STROKES as f64
    }

    /// What may be the cause, as a sentence.
    pub(crate) fn in_words(self) -> String {
        format!(
            "The errors are slow: the means over {:.1} s, of {STROKES} strokes, have {:.0} % of their square, as those of a sensor, a supply or a load that \
             drifts, and of a servo that friction, play or a dead band keeps off its commands",
            self.seconds,
            100.0 * self.share
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::identify::identify;
    use crate::options::Options;

    /// Levels at random that are held for 0.4 s, every 5 ms.
    fn levels(seed: usize) -> Vec<f64> {
        let level = |hold: usize| {
            ((hold * hold * 7919 + seed * 104_729 + hold * 31) % 61) as f64 / 2.0 - 15.0
        };
        (0..8000).map(|k| level(k / 80)).collect()
    }

    /// A lag of the input, to which `further` adds what is not linear of it, or not of it.
    fn slow(seed: usize, further: impl Fn(usize, f64) -> f64) -> Option<SlowErrors> {
        let input = levels(seed);
        let mut lag = 0.0;
        let output: Vec<f64> = (input.iter().enumerate())
            .map(|(k, u)| {
                lag += 0.1 * (u - lag);
                let noise = 0.1 * (0.7 * (k * k) as f64).sin();
                further(k, lag) + noise
            })
            .collect();
        let record = Record::of_run(0.005, input, output).unwrap();
        let model = identify(&record, &Options::default()).unwrap();
        SlowErrors::of(&record, &model)
    }

    #[test]
    fn a_drift_is_slow_and_what_depends_on_the_motion_is_not() {
        for seed in 0..2 {
            let drift = slow(seed, |k, y| {
                y + (k as f64 * 0.005 / 7.0 * std::f64::consts::TAU).sin()
            });
            assert!(
                drift.is_some_and(|found| found.share > 0.6),
                "{seed}: {drift:?}"
            );
            let stop = slow(seed, |_, y| y.min(9.0));
            assert_eq!(stop, None, "{seed}");
            let bent = slow(seed, |_, y| y + 0.02 * y * y);
            assert_eq!(bent, None, "{seed}");
        }
    }
}
