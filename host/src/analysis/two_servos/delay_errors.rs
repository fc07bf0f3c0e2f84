//! The delays that were taken out of two sides: how far their times may be off from each other.

use crate::data::dataset::{in_ms, own_part_s};
use crate::data::model_metadata::ModelMetadata;
use servoid_identification::comparison::{ComparisonOptions, DelayErrors};
use servoid_identification::results::{Advice, Check, six_digits};
use servoid_identification::servo_model::{ServoModel, WaitsForPulses};

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
        waits_s: waits_s(sides),
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

/// By how much the times of each side may be late alike, by a wait for pulses of its own \[s\].
pub(super) fn waits_s(sides: [&ModelMetadata; 2]) -> [f64; 2] {
    sides.map(|side| side.common_wait_s)
}

/// The same of servo models. Beside one whose commands are at their pulses, the delay of another may have a wait in it, where nothing states that its commands did not wait.
pub(super) fn waits_of_models_s(models: [&ServoModel; 2], sides: [&ModelMetadata; 2]) -> [f64; 2] {
    let [a, b] = models.map(|model| model.fit.waits_for_pulses);
    let wait_s = |side: &ModelMetadata,
                  own: Option<WaitsForPulses>,
                  other: Option<WaitsForPulses>| match (own, other) {
        (None, Some(other)) if may_wait(side) => side.common_wait_s.max(other.frame_s),
        (Some(_), _) => 0.0,
        _ => side.common_wait_s,
    };
    [wait_s(sides[0], a, b), wait_s(sides[1], b, a)]
}

/// That each recording may have one wait for pulses in all of its times.
pub(super) fn advice_on_waits(sides: [&ModelMetadata; 2]) -> Option<Advice> {
    let [a, b] = waits_s(sides);
    let longest_s = a.max(b);
    (longest_s > 0.0).then(|| {
        Advice::new(
            Check::CommandEdges,
            format!(
                "Where pulses come on a clock of their own, commands wait for them, and under these holds each recording has its own wait in all of its times: up to {:.0} ms of a difference in \
                 time may be of that, with frames of 20 ms, and none of the servos.",
                1e3 * longest_s
            ),
            longest_s,
            0.0,
            "Record three runs a side, whose bounds contain the waits. Where each command was changed with its pulse, and written in the row of that moment, say --exact-command.",
        )
    })
}

/// That the waits of single recordings are in a difference of them, where nothing says that no command waited.
pub(super) fn advice_on_chance(sides: [&ModelMetadata; 2]) -> Option<Advice> {
    sides.into_iter().any(may_wait).then(|| {
        Advice::new(
            Check::CommandEdges,
            "Where pulses came on a clock of their own, commands waited for them, and by chance several milliseconds longer in one of these recordings: all differences of time have that, and none of it is of the servos.",
            1.0,
            0.0,
            "Add --servo-model, which looks for such pulses and has delays without waits. Three runs a side have the chance in their bounds. Where each command was changed with its pulse, and written in the row of that moment, say --exact-command.",
        )
    })
}

/// Whether commands of a side may have waited for pulses.
fn may_wait(side: &ModelMetadata) -> bool {
    side.pulse_frame_s.is_none() && !side.exact_command
}

const ONE_SENSOR: &str =
    "Record both sides with one sensor and board, whose error is the same in both.";
