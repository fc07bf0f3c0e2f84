//! Whether the load of a servo model is why the servo rests off its command.

use crate::data::units::Units;
use crate::presentation::summary::{digits, shows_load, with_unit};
use servoid_identification::servo_model::{Load, ServoModel, ServoParameters};

/// By how much the load of the servo model moves the rest, and what to do about that, where it explains most of what the servo rests off its
/// command; `None` elsewhere.
pub(crate) fn remedy(model: &ServoModel, units: Units<'_>) -> Option<(f64, String)> {
    let by_load = of_load(&model.parameters(0), model.commands?.middle())?;
    let by = with_unit(digits(by_load, 3), units.output.unwrap_or_default());
    let remedy = match shows_load(model) {
        true => format!(
            "The servo model has a load as its cause, which moves the rest by {by}: look for what pulls to one side."
        ),
        false => format!(
            "The servo model has a load that moves the rest by {by}, but no interval shows that it is one: look at the zero of the sensor, at the horn on its spline and for what \
             pulls to one side."
        ),
    };
    let remedy = remedy
        + " The step response does not depend on where the servo rests; strokes against a load are slower.";
    Some((by_load, remedy))
}

/// By how much the load moves the rest under this command; `None` where that is not most of what the servo rests off it.
fn of_load(servo: &ServoParameters, command: f64) -> Option<f64> {
    let unloaded = ServoParameters {
        load: Load::None,
        ..*servo
    };
    let loaded = servo.resting_output(command);
    let by_load = loaded - unloaded.resting_output(command);
    let left = loaded - command - by_load;
    (by_load.abs() > left.abs()).then_some(by_load)
}

#[cfg(test)]
mod tests {
    use super::*;
    use servoid_identification::results::{Advice, Check};

    #[test]
    fn a_load_is_the_cause_where_the_zero_is_not() {
        let servo = |offset: f64, load: Load<f64>| ServoParameters {
            delay_s: 0.02,
            offset,
            load,
            ..ServoParameters::linear(2000.0, 80.0)
        };
        let found = of_load(&servo(0.02, Load::Constant(2000.0)), 5.0);
        assert!((found.unwrap() + 1.0).abs() < 1e-9, "{found:?}");
        assert_eq!(of_load(&servo(3.0, Load::Constant(2000.0)), 5.0), None);
        assert_eq!(of_load(&servo(3.0, Load::None), 5.0), None);
        assert_eq!(of_load(&servo(0.0, Load::None), 5.0), None);
    }

    #[test]
    fn a_load_explains_what_has_its_sign() {
        let rests = |off| Advice::new(Check::Zeros, "", off, 0.0, "Look at the zero.");
        let mut all = [rests(2.78), rests(-2.5)];
        Advice::name_load(&mut all, Some(-2.43), "The load.");
        assert_eq!(
            all.map(|item| item.remedy),
            ["Look at the zero.", "The load."]
        );
    }
}
