//! Whether the load of a servo model is why the servo rests off its command.

use crate::data::units::Units;
use crate::presentation::summary::digits;
use servoid_identification::servo_model::{Load, ServoModel, ServoParameters};

/// What to do about a rest off the command, where the load of the servo model explains most of it; `None` elsewhere.
pub(super) fn remedy(model: &ServoModel, units: Units<'_>) -> Option<String> {
    let servo = model.parameters(0);
    let command = model.commands?.middle();
    let unloaded = ServoParameters {
        load: Load::None,
        ..servo
    };
    let loaded = servo.resting_output(command);
    let by_load = loaded - unloaded.resting_output(command);
    let left = loaded - command - by_load;
    let unit = units.output.map(|unit| format!(" {unit}"));
    (by_load.abs() > left.abs()).then(|| {
        format!(
            "The servo model has a load as its cause, which moves the rest by {}{}: look for what pulls to one side. The step response does not \
             depend on it.",
            digits(by_load, 3),
            unit.unwrap_or_default()
        )
    })
}
