//! Two servos as machines beside each other, as far as their units allow.

use super::{delay_errors, scale_errors};
use crate::data::model_metadata::ModelMetadata;
use crate::data::pulse_widths::is_pulse;
use crate::presentation::summary::sixty_degrees;
use servoid_identification::comparison::{ServoModelComparison, compare_servo_models};
use servoid_identification::servo_model::ServoModel;

/// Compares two servo models whose positions have one unit. Where their commands do not, only what is of the position and of the time is compared. Offsets are no positions that a servo has where commands are pulse widths.
#[must_use]
pub fn compared_servos(
    models: [&ServoModel; 2],
    sides: [&ModelMetadata; 2],
) -> ServoModelComparison {
    let [a, b] = models;
    let found = compare_servo_models(
        a,
        b,
        scale_errors::ratio_sd(sides),
        delay_errors::own_error_s(sides),
    );
    let found = found.with_waits(delay_errors::waits_of_models_s(models, sides));
    let found = match sixty_degrees(sides[0].units()) {
        Some(size) => found.with_stroke(models, size),
        None => found,
    };
    match sides[0].other_command(sides[1]) {
        Some(_) => found.of_the_output_alone(),
        None if is_pulse(sides[0].units(), a.commands) => found.without_offset(),
        None => found,
    }
}
