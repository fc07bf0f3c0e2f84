//! The delays that were taken out of two sides: how far their times may be off from each other.

use crate::data::dataset::{in_ms, own_part_s};
use crate::data::model_metadata::ModelMetadata;
use servoid_identification::comparison::{ComparisonOptions, DelayErrors};
use servoid_identification::results::{Advice, Check, six_digits};
use servoid_identification::thresholds::RUNS_FOR_MEAN;

/// The options of a comparison that allows for what the files of both sides say of their delays.
pub(crate) fn allowed_for(
    sides: [&ModelMetadata; 2],
    options: ComparisonOptions,
) -> ComparisonOptions {
    let [a, b] = sides.map(|side| side.sensor_delay_uncertainty_s);
    ComparisonOptions {
        delay_errors: match are_shared(sides) {
            true => DelayErrors::Shared(a),
            false => DelayErrors::Apart([a, b]),
        },
        ..options
    }
}

/// How far off the delay of either servo model may be by itself, where the rest of the error is the same in both \[s\]; `None` where none is.
pub(super) fn own_error_s(sides: [&ModelMetadata; 2]) -> Option<f64> {
    match are_sent_alike(sides) {
        true => Some(own_part_s(sides[0].sensor_delay_uncertainty_s)),
        false => of_one_sensor(sides).then_some(0.0),
    }
}

/// Whether the error is the same in both: that of one sensor, or that of how a command was sent that moves on between the rows of both.
fn are_shared(sides: [&ModelMetadata; 2]) -> bool {
    are_sent_alike(sides) || of_one_sensor(sides)
}

/// Whether the commands of both move on between rows of one length.
fn are_sent_alike([a, b]: [&ModelMetadata; 2]) -> bool {
    a.moving_command
        && b.moving_command
        && a.sensor_delay_uncertainty_s == b.sensor_delay_uncertainty_s
}

/// Whether both were recorded by one board with the same delay, and the same uncertainty: the error of one sensor is the same in both.
fn of_one_sensor([a, b]: [&ModelMetadata; 2]) -> bool {
    a.sensor_delay_s.is_some()
        && a.sensor_delay_s == b.sensor_delay_s
        && a.sensor_delay_uncertainty_s == b.sensor_delay_uncertainty_s
        && a.board_id == b.board_id
}

/// That the times of the sides are known to each other within the errors of their delays only.
pub(crate) fn advice(sides: [&ModelMetadata; 2]) -> Option<Advice> {
    let errors_s = sides.map(|side| side.sensor_delay_uncertainty_s);
    let apart_ms = 1e3 * errors_s.iter().sum::<f64>();
    if are_shared(sides) || apart_ms == 0.0 {
        return None;
    }
    let [a, b] = sides.map(|side| side.sensor_delay_s);
    let (finding, remedy) = match a.zip(b) {
        Some((a, b)) if a == b => (
            "The sides were recorded by two sensors".to_owned(),
            ONE_SENSOR,
        ),
        Some((a, b)) => (
            format!(
                "The sides were recorded by sensors of different delays, {} and {} ms, which were taken out",
                in_ms(a),
                in_ms(b)
            ),
            ONE_SENSOR,
        ),
        None => (
            "The sides state the times of commands and positions within limits only".to_owned(),
            "Record both sides with an instrument that writes both columns at known times.",
        ),
    };
    Some(Advice::new(
        Check::SensorDelay,
        format!(
            "{finding}: their times may be off from each other by {} ms. Bounds of differences contain that.",
            six_digits(apart_ms)
        ),
        apart_ms,
        0.0,
        remedy,
    ))
}

/// Of files of another program with fewer runs than those whose bounds contain what differs from run to run: that all times of each may have a wait for pulses in them that is its own.
pub(super) fn advice_on_waits(
    sides: [&ModelMetadata; 2],
    fewest_runs: usize,
    lag_s: f64,
) -> Option<Advice> {
    let are_of_rows = sides.iter().all(|side| side.pulse_frame_s.is_none());
    (are_of_rows && fewest_runs < RUNS_FOR_MEAN).then(|| {
        Advice::new(
            Check::CommandEdges,
            "Where pulses come on a clock of their own, commands wait for them, and under holds of whole frames each recording has one wait of its own in all of its times, of up to a \
             frame: a difference in time of up to that, 20 ms as a rule, may be of these waits, and none of the servos.",
            lag_s,
            0.0,
            "Change each command with the pulse, and write it in the row of that moment; or record three runs a side, whose bounds contain the waits.",
        )
    })
}

const ONE_SENSOR: &str =
    "Record both sides with one sensor and board, whose error is the same in both.";
