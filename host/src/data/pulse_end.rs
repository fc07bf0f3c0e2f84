//! What the length of a pulse adds to a delay, where commands are pulses or stand for them.

use crate::data::model_metadata::unit_meant;
use crate::data::neutral::neutral;
use crate::data::pulse_widths::is_pulse;
use crate::data::units::Units;
use servoid_identification::servo_model::{CommandRange, PulseEnd};

/// How much longer the pulse of the servo is for each unit of the command, and the neutral one: of pulses, and of degrees whose pulse is known (µs/deg).
#[must_use]
pub(crate) fn pulses(
    units: Units<'_>,
    recorded: Option<CommandRange>,
    us_per_degree: Option<f64>,
) -> Option<PulseEnd> {
    if is_pulse(units, recorded) {
        return Some(PulseEnd {
            s_per_command: 1e-6,
            neutral: neutral(units, recorded),
        });
    }
    let us = us_per_degree.filter(|_| units.input.and_then(unit_meant).as_deref() == Some("deg"));
    us.map(|us| PulseEnd {
        s_per_command: 1e-6 * us,
        neutral: 0.0,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pulse_is_known_by_its_unit_its_size_and_its_scale() {
        let of = |input: Option<&str>, least: f64, largest: f64, us_per_degree| {
            let units = Units {
                input,
                output: Some("deg"),
            };
            let recorded = Some(CommandRange { least, largest });
            let end = pulses(units, recorded, us_per_degree)?;
            Some([end.later_s(largest), end.later_s(least)].map(|s| (1e9 * s).round()))
        };
        let all = Some([400e3, -300e3]);
        assert_eq!(of(Some("us"), 1200.0, 1900.0, None), all);
        assert_eq!(of(None, 1200.0, 1900.0, None), all);
        assert_eq!(of(Some("deg"), -30.0, 40.0, Some(10.0)), all);
        assert_eq!(
            of(Some("deg"), -40.0, 30.0, Some(-10.0)),
            Some([-300e3, 400e3])
        );
        assert_eq!(of(Some("us"), 600.0, 900.0, None), Some([150e3, -150e3]));
        assert_eq!(of(Some("deg"), -30.0, 40.0, None), None);
        assert_eq!(of(None, -30.0, 40.0, None), None);
    }
}
