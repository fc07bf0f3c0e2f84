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

/// Under the command of 5 the spring balances full drive at 3: the rests are all where a stop would be, and there is none.
#[test]
fn a_load_that_stalls_the_drive_is_no_stop() {
    let terms = Terms {
        limit: true,
        friction: true,
        load: LoadKind::Spring,
        ..Terms::default()
    };
    let stiff = |at: Coordinate| match at {
        Coordinate::Spring => 0.6,
        at => value(at),
    };
    let servo = point(terms, stiff);
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
