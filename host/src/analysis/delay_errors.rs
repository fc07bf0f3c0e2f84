//! The delays that were taken out of two sides: how far their times may be off from each other.

use crate::data::model_metadata::ModelMetadata;
use servoid_identification::comparison::ComparisonOptions;
use servoid_identification::results::six_digits;
use servoid_identification::results::{Advice, Check};

/// The options of a comparison that allows for what the files of both sides say of their delays.
pub(super) fn allowed_for(
    sides: [&ModelMetadata; 2],
    options: ComparisonOptions,
) -> ComparisonOptions {
    ComparisonOptions {
        delay_errors_s: sides.map(|side| side.sensor_delay_uncertainty_s),
        one_delay_error: of_one_sensor(sides),
        ..options
    }
}

/// Whether both state the same delay, and the same uncertainty: the error of one sensor is the same in both.
fn of_one_sensor([a, b]: [&ModelMetadata; 2]) -> bool {
    a.sensor_delay_s.is_some()
        && a.sensor_delay_s == b.sensor_delay_s
        && a.sensor_delay_uncertainty_s == b.sensor_delay_uncertainty_s
}

/// That the times of the sides are known to each other within the errors of their delays only.
pub(super) fn advice(sides: [&ModelMetadata; 2]) -> Option<Advice> {
    let errors_s = sides.map(|side| side.sensor_delay_uncertainty_s);
    let apart_ms = in_ms(errors_s.iter().sum());
    if of_one_sensor(sides) || apart_ms == 0.0 {
        return None;
    }
    let [a, b] = sides.map(|side| side.sensor_delay_s);
    let (finding, remedy) = match a.zip(b) {
        Some((a, b)) => (
            format!(
                "The sides were recorded by sensors of different delays, {} and {} ms: both were taken out",
                in_ms(a),
                in_ms(b)
            ),
            "Record both sides with one sensor, whose error is the same in both.",
        ),
        None => (
            "The sides state the times of commands and positions to within limits only".to_owned(),
            "Record both sides with an instrument that writes both columns at known times.",
        ),
    };
    Some(Advice::new(
        Check::SensorDelay,
        format!(
            "{finding}. Their difference may be off by {apart_ms} ms, which the bounds of all differences contain."
        ),
        apart_ms,
        0.0,
        remedy,
    ))
}

fn in_ms(seconds: f64) -> f64 {
    six_digits(1e3 * seconds)
}
