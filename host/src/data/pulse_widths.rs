//! Commands that are pulse widths by their size, whatever is said of their unit.

use crate::data::model_metadata::unit_meant;
use crate::data::units::Units;
use servoid_identification::servo_model::CommandRange;
use servoid_protocol::PulseWidth;
use std::ops::RangeInclusive;

/// Pulses that R/C servos take \[us\], narrow ones apart.
const PULSES_US: RangeInclusive<f64> = 500.0..=2500.0;

/// Whether commands between these are pulses: they go through the neutral one, and no angle of a servo is that large.
#[must_use]
pub(crate) fn are_pulses(least: f64, largest: f64) -> bool {
    let neutral = f64::from(PulseWidth::NEUTRAL.0);
    let is_one = |end: f64| PULSES_US.contains(&end);
    least < largest && is_one(least) && is_one(largest) && (least..=largest).contains(&neutral)
}

/// Whether the command is the pulse itself, in us: by its unit or, where that is not known, by the recorded ones.
#[must_use]
pub(crate) fn is_pulse(units: Units<'_>, recorded: Option<CommandRange>) -> bool {
    match units.input.and_then(unit_meant) {
        Some(unit) => unit == "us",
        None => recorded.is_some_and(|range| are_pulses(range.least, range.largest)),
    }
}

/// "its values, 1086 to 1915, are pulse widths in us by their size", of a command whose unit is not known, or an angle.
#[must_use]
pub(crate) fn doubt(unit: Option<&str>, least: f64, largest: f64) -> Option<String> {
    let is_other = matches!(unit, None | Some("deg" | "rad"));
    (is_other && are_pulses(least, largest)).then(|| {
        let said = unit.map_or_else(
            || "names no unit".to_owned(),
            |unit| format!("says {unit}"),
        );
        format!("{said}, and its values, {least:.0} to {largest:.0}, are pulse widths in us by their size")
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_angle_is_a_pulse() {
        assert!(doubt(Some("deg"), 1086.0, 1915.0).is_some());
        assert!(doubt(None, 900.0, 2100.0).is_some());
        assert!(doubt(Some("us"), 1086.0, 1915.0).is_none());
        // A sail winch of several turns, a sensor of 12 bits, narrow pulses.
        assert!(doubt(Some("deg"), 0.0, 2160.0).is_none());
        assert!(doubt(None, 12.0, 4090.0).is_none());
        assert!(doubt(None, 560.0, 960.0).is_none());
        assert!(doubt(None, 1500.0, 1500.0).is_none());
    }
}
