//! Units that cannot be right by the size of the numbers: a file for a program with units of its own is then wrong by a factor.

use crate::data::pulse_widths;
use crate::data::units::Units;
use crate::presentation::summary;
use servoid_identification::servo_model::{CommandRange, ServoModel};

/// A sentence for each unit that is in doubt, by these commands and the speeds of a servo model, where there is one.
pub(super) fn of_units(
    commands: Option<CommandRange>,
    model: Option<&ServoModel>,
    units: Units<'_>,
) -> Vec<String> {
    let pulses =
        commands.and_then(|range| pulse_widths::doubt(units.input, range.least, range.largest));
    let pulses = pulses.map(|doubt| match units.input {
        Some(_) => format!(
            "the column of the command {doubt}: if they are, the numbers of this file are wrong by a factor; put us into the name of the column and identify again"
        ),
        None => format!(
            "the column of the command {doubt}: this file takes them for that; put the unit into the name of the column (u_us) and identify again"
        ),
    });
    let speed = model.and_then(|model| summary::unlikely_speed(model, units));
    let speed = speed.map(|how| {
        format!("by this model the servo is {how}; where one is wrong, so is this file")
    });
    pulses.into_iter().chain(speed).collect()
}
