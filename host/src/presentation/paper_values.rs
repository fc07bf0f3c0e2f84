//! The paper's facts beside ours.
//!
//! The numbers are those of §4.3 and Figs 5, 9 and 12 of "Investigation of Small Scale Helicopter
//! Servo-Actuator Performance Using Frequency Sampling Filters". The simulated servos were fitted to
//! them: agreement here shows that the chain works from end to end, not what any real servo does.

use serde::Serialize;
use servoid_identification::comparison::Comparison;
use servoid_identification::results::Model;

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
    /// Decimals that ours is printed with.
    #[serde(skip)]
    pub digits: usize,
}

/// The staircase's level (deg, paper §4).
const LEVEL_DEG: f64 = 5.0;

/// Samples after an edge from which the servo is taken to be at rest: the paper's bench servo
/// "achieves steady state in approximately 60 sampling intervals" (§4.3).
pub const WAIT_SAMPLES: usize = 60;

/// Holds the models of bench and aircraft, and their comparison, against the paper.
#[must_use]
pub fn facts(bench: &Model, aircraft: &Model, comparison: &Comparison) -> Vec<Fact> {
    let mut facts = vec![
        Fact {
            figure: "5",
            fact: "bench settles within 1 % (samples)",
            paper: 60.0,
            here: settled_after(&bench.step.value, 0.01) as f64,
            digits: 0,
        },
        Fact {
            figure: "12",
            fact: "bench overshoot over +5 deg (deg)",
            paper: 0.2,
            here: highest_at(bench, LEVEL_DEG) - LEVEL_DEG,
            digits: 2,
        },
        Fact {
            figure: "12",
            fact: "aircraft undershoot at +5 deg (deg)",
            paper: 1.2,
            here: LEVEL_DEG - level_at(aircraft, LEVEL_DEG),
            digits: 2,
        },
    ];
    let over = comparison
        .over_prediction
        .as_ref()
        .and_then(|over| over.plus_percent.value);
    facts.extend(over.map(|here| Fact {
        figure: "9",
        fact: "bench model over-predicts aircraft at +5 deg (%)",
        paper: 22.0,
        here,
        digits: 1,
    }));
    facts
}

/// The facts as lines for a terminal.
#[must_use]
pub fn as_table(facts: &[Fact]) -> String {
    let head = format!(
        "{:50} {:>6} {:>10} {:>10}\n",
        "the paper", "figure", "paper", "here"
    );
    let line = |f: &Fact| {
        format!(
            "{:50} {:>6} {:>10} {:>10.*}\n",
            f.fact, f.figure, f.paper, f.digits, f.here
        )
    };
    head + &facts.iter().map(line).collect::<String>()
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settling_counts_from_the_last_time_outside() {
        assert_eq!(settled_after(&[0.0, 0.5, 1.2, 0.995, 1.0], 0.01), 3);
        assert_eq!(settled_after(&[1.0, 1.0], 0.01), 0);
    }
}
