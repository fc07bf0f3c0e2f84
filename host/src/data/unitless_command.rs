//! What a command without a unit stands for.

use super::model_metadata::unit_meant;
use super::pulse_widths::are_pulses;
use super::units::Units;
use servoid_identification::servo_model::ServoModel;

/// The pulse of a full command beside the neutral one \[us\].
pub(crate) const FULL_US: f64 = 500.0;

/// What is made of a command whose column names no unit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum UnitlessCommand {
    /// A pulse width in us, which its size shows.
    PulseWidth,
    /// A part of a full one, -1 to 1: a small one, of a servo whose position is an angle.
    PartOfFull,
    /// An angle in rad: a small one, and the position has no unit either.
    Radians,
    /// An angle in degrees.
    Degrees,
}

impl UnitlessCommand {
    /// That of a model; `None` where the unit is known.
    #[must_use]
    pub fn of(units: Units<'_>, model: &ServoModel) -> Option<Self> {
        if units.input.and_then(unit_meant).is_some() {
            return None;
        }
        if (model.commands).is_some_and(|range| are_pulses(range.least, range.largest)) {
            return Some(Self::PulseWidth);
        }
        let position = units.output.and_then(unit_meant);
        let is_small = model.radians_per_command == 1.0;
        Some(match (is_small, position.as_deref()) {
            (true, Some("deg" | "rad")) => Self::PartOfFull,
            (true, _) => Self::Radians,
            (false, _) => Self::Degrees,
        })
    }
}
