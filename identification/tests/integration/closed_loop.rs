//! Recordings in closed loop have no bounds, or bounds that hold; open loops are not taken for closed ones. The table "Closed loop"
//! of docs/assumptions.md has more runs of each line.

use std::f64::consts::TAU;

use rand::RngExt;
use rand_distr::StandardNormal;
use servoid_identification::results::{Check, Reason};
use servoid_identification::{Options, Record, identify, identify_explained};
use servoid_test_support::closed_loop::{Course, Loop};
use servoid_test_support::plants::{Noise, Plant, normal, random};
use servoid_test_support::servos::{Limit, limited_in_steps};

/// Saves most of the time; the servo settles well within it.
fn options() -> Options {
    Options {
        longest_settling: Some(301),
        ..Options::default()
    }
}

fn of(course: Course, controller: Option<f64>, scale: f64, delay: usize) -> Loop {
    Loop {
        course,
        controller,
        plant: Plant::A,
        noise: Noise::Ar1,
        scale,
        delay,
    }
}

#[test]
fn a_controller_takes_the_level_where_it_bends_the_response() {
    let (mut withdrawn, mut named) = (0, 0);
    let lines = [
        of(Course::Staircase, Some(0.3), 10.0, 0),
        of(Course::Telegraph, Some(0.3), 3.0, 0),
        of(Course::Prbs, Some(0.3), 10.0, 1),
        of(Course::Telegraph, Some(0.3), 10.0, 5),
    ];
    for line in lines {
        for seed in 100..104 {
            let trial = line.trial(&mut random(seed));
            let model = identify(&trial.record, &options()).unwrap();
            let Some(bounds) = model.step.bounds.valid() else {
                withdrawn += 1;
                named += usize::from(model.bounds.withdrawn() == Some(Reason::InputFollowsOutput));
                continue;
            };
            let whole = &bounds.simultaneous;
            let inside = (whole.lower.iter().zip(&whole.upper).zip(&trial.truth))
                .all(|((lower, upper), truth)| lower <= truth && truth <= upper);
            assert!(inside, "{line:?}");
        }
    }
    // Of the same lines with other seeds 19 of 24 had no bounds, 15 of them for this reason: of 16, three standard deviations
    // (binomial) below that are 7 and 4.
    assert!(withdrawn >= 8 && named >= 5, "{withdrawn}, {named}");
}

#[test]
fn an_open_loop_is_open() {
    for course in [Course::Staircase, Course::Telegraph, Course::Prbs] {
        for seed in 100..104 {
            let trial = of(course, None, 1.0, 0).trial(&mut random(seed));
            let found = identify_explained(&trial.record, &options()).unwrap();
            assert!(found.model.bounds.valid().is_some(), "{course:?}");
            let feedback = found.explanation.feedback.unwrap();
            assert!(!feedback.is_found(), "{feedback:?}");
        }
    }
}

#[test]
fn feedback_is_named_and_not_called_nonlinear() {
    let trial = of(Course::Prbs, Some(0.3), 10.0, 0).trial(&mut random(3));
    let model = identify(&trial.record, &options()).unwrap();
    let checks: Vec<&Check> = model.advice.iter().map(|found| &found.check).collect();
    assert!(checks.contains(&&Check::Feedback), "{checks:?}");
    assert!(!checks.contains(&&Check::ModelError), "{checks:?}");
}

/// u = -0.3 y in every sample: the estimate is the inverse of the controller, and exact.
#[test]
fn a_regulator_alone_is_no_servo() {
    for (seed, white) in [(1, 0.0), (2, 0.2), (3, 1.0)] {
        let mut random = random(seed);
        let (mut drift, mut servo, mut input, mut output) = (0.0, 0.0, Vec::new(), Vec::new());
        for _ in 0..3600 {
            servo += 0.05 * (input.last().copied().unwrap_or(0.0) - servo);
            drift = 0.98 * drift + 0.3 * random.sample::<f64, _>(StandardNormal);
            let y = servo + drift + white * random.sample::<f64, _>(StandardNormal);
            // As a file has it.
            output.push((1e4 * y).round() / 1e4);
            input.push((-0.3e4 * y).round() / 1e4);
        }
        let record = Record::of_run(0.002, &input, &output).unwrap();
        let model = identify(&record, &Options::default()).unwrap();
        assert_eq!(
            model.bounds.withdrawn(),
            Some(Reason::InputFollowsOutput),
            "{seed}"
        );
    }
}

/// A sum of sines up to 3 Hz, sent in frames of 20 ms and recorded in rows of 10 ms, to a servo with a limit of its speed: its errors go with what comes next in the command,
/// as in a loop. The fifth was called one.
#[test]
fn a_planned_sum_of_sines_in_pulse_frames_is_no_loop() {
    for seed in 0..16 {
        let mut random = random(400 + seed);
        let sines: Vec<(f64, f64)> = [0.1, 0.3, 0.7, 1.1, 1.7, 2.3, 3.0]
            .map(|hertz: f64| (TAU * hertz, random.random_range(0.0..TAU)))
            .to_vec();
        let at = |t: f64| -> f64 {
            sines
                .iter()
                .map(|(w, phase)| 6.0 * (w * t + phase).sin())
                .sum()
        };
        let sent = |k: usize| match k {
            200..2200 => at((k - k % 2 - 200) as f64 * 0.01),
            _ => 0.0,
        };
        let input: Vec<f64> = (0..2400).map(sent).collect();
        let late = (2e-4, 50, 23);
        let clean = limited_in_steps(1.05, 65.0, Limit::Rate(280.0, 280.0), &input, 0.0, late);
        let output: Vec<f64> = clean
            .iter()
            .map(|y| y + 0.07 * normal(&mut random))
            .collect();
        let record = Record::of_run(0.01, &input, output).unwrap();
        let model = identify(&record, &Options::default()).unwrap();
        assert_ne!(
            model.bounds.withdrawn(),
            Some(Reason::InputFollowsOutput),
            "{seed}"
        );
    }
}
