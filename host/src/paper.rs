//! The paper's facts beside ours.
//!
//! The numbers are those of §4.3 and Figs 5, 9 and 12 of "Investigation of Small Scale Helicopter
//! Servo-Actuator Performance Using Frequency Sampling Filters". The simulated servos were fitted to
//! them: agreement here shows that the chain works from end to end, not what any real servo does.

use serde::Serialize;
use servoid_identification::{Model, Run};

/// One fact: what the paper says, and what was found here.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Fact {
    /// The paper's figure that shows it.
    pub figure: &'static str,
    /// What is measured, and its unit.
    pub fact: &'static str,
    /// The paper's number.
    pub paper: f64,
    /// Ours.
    pub here: f64,
}

/// The staircase's level (deg, paper §4).
const LEVEL_DEG: f64 = 5.0;

/// Samples after an edge from which the servo is taken to be at rest: the paper's bench servo
/// "achieves steady state in approximately 60 sampling intervals" (§4.3).
pub const WAIT_SAMPLES: usize = 60;

/// Compares a bench model and an aircraft model, and the aircraft's recording, with the paper.
#[must_use]
pub fn facts(bench: &Model, aircraft: &Model, aircraft_run: &Run) -> Vec<Fact> {
    let mut facts = vec![
        Fact {
            figure: "5",
            fact: "bench settles within 1 % (samples)",
            paper: 60.0,
            here: settled_after(&bench.step.value, 0.01) as f64,
        },
        Fact {
            figure: "12",
            fact: "bench overshoot over +5 deg (deg)",
            paper: 0.2,
            here: highest_at(bench, LEVEL_DEG) - LEVEL_DEG,
        },
        Fact {
            figure: "12",
            fact: "aircraft undershoot at +5 deg (deg)",
            paper: 1.2,
            here: LEVEL_DEG - level_at(aircraft, LEVEL_DEG),
        },
    ];
    if let Some(share) = over_prediction(bench, aircraft_run) {
        facts.push(Fact {
            figure: "9",
            fact: "bench model over-predicts aircraft at +5 deg (%)",
            paper: 22.0,
            here: 100.0 * share,
        });
    }
    facts
}

/// The first sample from which a step response stays within `band` of its final value.
fn settled_after(step: &[f64], band: f64) -> usize {
    let Some(&last) = step.last() else { return 0 };
    step.iter()
        .rposition(|g| (g - last).abs() > band * last.abs())
        .map_or(0, |m| m + 1)
}

/// Where the model rests when `input` is held.
fn level_at(model: &Model, input: f64) -> f64 {
    model.offset + input * model.step.value.last().copied().unwrap_or(f64::NAN)
}

/// The model's highest point after a step from `-input` to `input`.
fn highest_at(model: &Model, input: f64) -> f64 {
    let start = level_at(model, -input);
    model
        .step
        .value
        .iter()
        .map(|g| start + 2.0 * input * g)
        .fold(f64::NEG_INFINITY, f64::max)
}

/// How much more the model moves than the measurement on the plateaus where the input is at its
/// highest: 1 - sum y / sum y_model over the samples that follow an edge by [`WAIT_SAMPLES`] or
/// more. `None` where there are none.
fn over_prediction(model: &Model, run: &Run) -> Option<f64> {
    let highest = run
        .input()
        .iter()
        .copied()
        .filter(|u| u.is_finite())
        .fold(f64::NAN, f64::max);
    let mut since_edge = 0;
    let (mut measured, mut predicted) = (0.0, 0.0);
    let samples = run
        .input()
        .iter()
        .zip(run.output())
        .zip(model.simulate(run));
    for ((&u, &y), y_model) in samples {
        since_edge = if u == highest { since_edge + 1 } else { 0 };
        if since_edge > WAIT_SAMPLES && !(y + y_model).is_nan() {
            measured += y;
            predicted += y_model;
        }
    }
    (predicted != 0.0).then(|| 1.0 - measured / predicted)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settling_counts_from_the_last_time_outside() {
        assert_eq!(settled_after(&[0.0, 0.5, 1.2, 0.995, 1.0], 0.01), 3);
        assert_eq!(settled_after(&[1.0, 1.0], 0.01), 0);
    }
}
