//! Of the stops that a recording may show, those that the motion has are in the model.

use super::{PERIOD_S, noisy, point, strokes, value};
use crate::data::Record;
use crate::servo_model::descent::coordinates::Terms;
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
