//! Pulses that a servo knows at their ends, and those that it is said to know before.

use super::{PERIOD_S, noisy, point, require_held, strokes, value};
use crate::data::Record;
use crate::servo_model::descent::coordinates::{LoadKind, Point, Terms};
use crate::servo_model::{ServoModel, ServoModelOptions, fit};
use servoid_dynamics::PulseEnd;

/// Levels of up to 5 units act up to 1.5 ms later or earlier, which at the top speed of 190 units/s are nine times the noise.
const PULSES: PulseEnd = PulseEnd {
    s_per_command: 3e-4,
    neutral: 0.0,
};

fn limited() -> Point {
    let terms = Terms {
        limit: true,
        friction: true,
        ..Terms::default()
    };
    point(terms, value)
}

fn found(servo: &Point, pulses: Option<PulseEnd>, seed: u64) -> ServoModel {
    let input = strokes(3000);
    let record = Record::of_run(PERIOD_S, &input, noisy(servo, &input, seed)).unwrap();
    let options = ServoModelOptions {
        pulses,
        ..ServoModelOptions::default()
    };
    fit(&record, &options).unwrap()
}

#[test]
fn a_pulse_that_acts_at_its_end_is_no_load() {
    let servo = Point {
        pulse_end: Some(PULSES),
        ..limited()
    };
    let known = found(&servo, Some(PULSES), 3);
    assert_eq!(known.pulse_end, Some(PULSES));
    assert_eq!(
        (known.terms.load, known.terms.two_speeds),
        (LoadKind::None, false)
    );
    assert_eq!(
        known.covariance.withdrawn(),
        None,
        "{:?} {:?}",
        known.terms,
        known.fit
    );
    require_held(
        &known,
        &servo,
        &["delay", "top speed upwards", "resting error by friction"],
    );
    // Nothing else in the model stands for it. The strokes are a third of the record.
    let unknown = found(&servo, None, 3);
    assert!(
        known.fit.rmse < 0.9 * unknown.fit.rmse,
        "{} {}",
        known.fit.rmse,
        unknown.fit.rmse
    );
    let again: ServoModel = serde_json::from_str(&serde_json::to_string(&known).unwrap()).unwrap();
    assert_eq!(again.pulse_end, Some(PULSES));
}

#[test]
fn a_servo_whose_delay_is_that_of_all_commands_is_not_said_to_know_pulses_at_their_ends() {
    for seed in [1, 2] {
        assert_eq!(found(&limited(), Some(PULSES), seed).pulse_end, None);
    }
}
