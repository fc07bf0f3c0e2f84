//! The command that a servo is under before it gets another.

use crate::data::pulse_widths::is_pulse;
use crate::data::units::Units;
use servoid_identification::servo_model::CommandRange;

/// The neutral pulse of R/C servos \[us\].
pub(crate) const NEUTRAL_US: f64 = 1500.0;

/// The neutral command, which is a pulse of 1500 us, or 0 in other units; where the recorded commands leave it out, their middle.
pub(crate) fn neutral(units: Units<'_>, recorded: Option<CommandRange>) -> f64 {
    let usual = match is_pulse(units, recorded) {
        true => NEUTRAL_US,
        false => 0.0,
    };
    recorded
        .filter(|range| !(range.least..=range.largest).contains(&usual))
        .map_or(usual, |range| range.middle())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_within_what_was_recorded() {
        let of = |unit, least, largest| {
            let units = Units {
                input: unit,
                output: Some("deg"),
            };
            neutral(units, Some(CommandRange { least, largest }))
        };
        assert_eq!(of(Some("us"), 1100.0, 1596.0), 1500.0);
        assert_eq!(of(Some("us"), 600.0, 900.0), 750.0);
        assert_eq!(of(Some("deg"), -20.0, 60.0), 0.0);
        assert_eq!(of(None, 4.0, 6.0), 5.0);
        assert_eq!(of(None, 1100.0, 1596.0), 1500.0);
    }
}
