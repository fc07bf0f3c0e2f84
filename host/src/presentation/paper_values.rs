//! The paper's values beside those found here.
//!
//! The numbers are those of §4.3 and Figs 5, 9 and 12 of "Investigation of Small Scale Helicopter
//! Servo-Actuator Performance Using Frequency Sampling Filters". The simulated servos were fitted to
//! them: agreement here shows that the chain works from end to end, not what any real servo does.

use serde::Serialize;
use servoid_identification::comparison::Comparison;
use servoid_identification::results::Model;

/// A value of the paper, and the same as found here.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Fact {
    /// The paper's figure that shows it.
    pub figure: &'static str,
    /// The quantity, and its unit.
    pub fact: &'static str,
    /// The paper's number.
    pub paper: f64,
    /// The number found here.
    pub here: f64,
    /// Decimals of the number found here.
    #[serde(skip)]
    pub digits: usize,
}

/// The staircase's level (deg, paper §4).
const LEVEL_DEG: f64 = 5.0;

/// Samples after an edge from which the servo is taken to be at rest: the paper's bench servo
/// "achieves steady state in approximately 60 sampling intervals" (§4.3).
pub(crate) const WAIT_SAMPLES: usize = 60;

/// The paper's values beside those of these models and their comparison.
pub(crate) fn facts(bench: &Model, aircraft: &Model, comparison: &Comparison) -> Vec<Fact> {
    let fact = |figure, fact, paper, here, digits| Fact {
        figure,
        fact,
        paper,
        here,
        digits,
    };
    let settled = settled_after(&bench.step.value, 0.01) as f64;
    let overshoot = highest_at(bench, LEVEL_DEG) - LEVEL_DEG;
    let undershoot = LEVEL_DEG - level_at(aircraft, LEVEL_DEG);
    let mut facts = vec![
        fact("5", "bench settles within 1 % (samples)", 60.0, settled, 0),
        fact("12", "bench overshoot over +5 deg (deg)", 0.2, overshoot, 2),
        fact(
            "12",
            "aircraft undershoot at +5 deg (deg)",
            1.2,
            undershoot,
            2,
        ),
    ];
    let over = comparison.over_prediction.as_ref();
    if let Some(percent) = over.and_then(|over| over.plus_percent.value) {
        let name = "bench model over-predicts aircraft at +5 deg (%)";
        facts.push(fact("9", name, 22.0, percent, 1));
    }
    facts
}

/// The facts as lines for a terminal.
pub(crate) fn as_table(facts: &[Fact]) -> String {
    let [name, figure, paper, here] = ["the paper", "figure", "paper", "here"];
    let head = format!("{name:50} {figure:>6} {paper:>10} {here:>10}\n");
    let line = |f: &Fact| {
        let Fact {
            figure,
            fact,
            paper,
            here,
            digits,
        } = f;
        format!("{fact:50} {figure:>6} {paper:>10} {here:>10.digits$}\n")
    };
    head + &facts.iter().map(line).collect::<String>()
}

/// The first sample from which a step response stays within `band` of its final value.
fn settled_after(step: &[f64], band: f64) -> usize {
    let Some(&last) = step.last() else { return 0 };
    let outside = |g: &f64| (g - last).abs() > band * last.abs();
    step.iter().rposition(outside).map_or(0, |m| m + 1)
}

/// Where the model rests when `input` is held.
fn level_at(model: &Model, input: f64) -> f64 {
    model.offset + input * model.step.value.last().copied().unwrap_or(f64::NAN)
}

/// The model's highest point after a step from `-input` to `input`.
fn highest_at(model: &Model, input: f64) -> f64 {
    let start = level_at(model, -input);
    let course = model.step.value.iter().map(|g| start + 2.0 * input * g);
    course.fold(f64::NEG_INFINITY, f64::max)
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
