//! Of the stops that a recording may show, those that the motion has are in the model.

use super::{PERIOD_S, noisy, point, strokes, value};
use crate::data::Record;
use crate::servo_model::descent::coordinates::{Coordinate, LoadKind, Terms};
use crate::servo_model::{ServoModelOptions, fit};

/// The servo stops at 2 degrees upwards. Downwards it goes to -5, and what is said to be a stop at -3 is none.
#[test]
fn of_two_stops_the_one_that_the_motion_shows_is_taken() {
    let terms = Terms {
        limit: true,
        ..Terms::default()
    };
    let mut servo = point(terms, value);
    servo.stops.upper = Some(2.0);
    let input = strokes(2400);
    let record = Record::of_run(PERIOD_S, &input, noisy(&servo, &input, 8)).unwrap();
    let options = ServoModelOptions {
        stops_at: vec![2.0, -3.0],
        ..ServoModelOptions::default()
    };
    let found = fit(&record, &options).unwrap();
    assert_eq!(found.stops, servo.stops);
    // With neither or both of them it predicts 60 to 90 %.
    assert!(found.fit.held_out_percent > 98.0, "{:?}", found.fit);
}

/// The terms of a servo with friction that turns against a spring.
fn on_a_spring() -> Terms {
    Terms {
        limit: true,
        friction: true,
        load: LoadKind::Spring,
        ..Terms::default()
    }
}

/// Under the command of 5 the spring balances full drive at 3: the rests are all where a stop would be, and there is none.
#[test]
fn a_load_that_stalls_the_drive_is_no_stop() {
    let stiff = |at: Coordinate| match at {
        Coordinate::Spring => 0.6,
        at => value(at),
    };
    let servo = point(on_a_spring(), stiff);
    let input = strokes(2400);
    let record = Record::of_run(PERIOD_S, &input, noisy(&servo, &input, 9)).unwrap();
    let stalled = servo.physics(0, |_, value| value).resting_output(5.0);
    let options = ServoModelOptions {
        stops_at: vec![stalled],
        ..ServoModelOptions::default()
    };
    let found = fit(&record, &options).unwrap();
    assert!(found.stops.are_none(), "{:?}", found.stops);
    assert!(found.fit.held_out_percent > 98.0, "{:?}", found.fit);
}

/// Nothing says that there is a stop, and one command alone goes beyond it, of a servo whose friction lets it rest beside its commands under a spring.
#[test]
fn a_stop_that_one_command_meets_is_found_beside_a_spring() {
    let stiff = |at: Coordinate| match at {
        Coordinate::Spring => 0.2,
        Coordinate::Friction => 0.6,
        at => value(at),
    };
    let mut servo = point(on_a_spring(), stiff);
    servo.stops.upper = Some(servo.physics(0, |_, value| value).resting_output(3.1));
    // The first stroke alone goes to 5, all others to 3 at the most.
    let mut input = strokes(6000);
    let beyond = input.iter().position(|level| *level == 5.0).unwrap();
    let behind = beyond
        + input[beyond..]
            .iter()
            .take_while(|level| **level == 5.0)
            .count();
    for level in &mut input[behind..] {
        *level = level.min(3.0);
    }
    let record = Record::of_run(PERIOD_S, &input, noisy(&servo, &input, 10)).unwrap();
    let found = fit(&record, &ServoModelOptions::default()).unwrap();
    let (upper, truth) = (found.stops.upper.unwrap(), servo.stops.upper.unwrap());
    // The median of a few dozen samples in noise of 0.03.
    assert!((upper - truth).abs() < 0.03, "{upper} {truth}");
    assert!(found.fit.held_out_percent > 98.0, "{:?}", found.fit);
}
