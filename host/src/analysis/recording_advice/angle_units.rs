//! Radians beside degrees within one recording, by its gain.

use crate::data::dataset::Dataset;
use crate::data::model_metadata::unit_meant;
use crate::data::units::Units;
use crate::presentation::summary::four_digits;
use servoid_identification::column::span;
use servoid_identification::results::{Advice, Check, Model};

/// Gains this near to the ratio of radians and degrees are doubted \[%\]: a servo whose two columns are in one unit has a gain of 1 within
/// about as much.
const NEAR_PERCENT: f64 = 5.0;

/// That the gain is the ratio of radians and degrees, where the columns do not name two units.
pub(crate) fn advice_on_gain(model: &Model, units: Units<'_>) -> Option<Advice> {
    let meant = [units.input, units.output].map(|unit| unit.and_then(unit_meant));
    let named: Vec<&str> = meant.iter().flatten().map(String::as_str).collect();
    let are_angles = named.iter().all(|unit| ["deg", "rad"].contains(unit));
    if !are_angles || matches!(named[..], [input, output] if input != output) {
        return None;
    }
    let gain = model.metrics.dc_gain.value?;
    let (ratio, [name, output, input, inverse]) = match gain.abs() < 1.0 {
        true => (
            1f64.to_radians(),
            ["pi/180", "radians", "degrees", "57.29578"],
        ),
        false => (
            1f64.to_degrees(),
            ["180/pi", "degrees", "radians", "0.01745329"],
        ),
    };
    let percent = 100.0 * (gain.abs() / ratio - 1.0).abs();
    let both = match named[..] {
        [unit, _] => format!(", though both columns are named {unit}"),
        _ => String::new(),
    };
    (percent <= NEAR_PERCENT).then(|| {
        Advice::new(
            Check::UnitMix,
            format!(
                "The gain is {}, which is {name} within {:.1} %: the output looks like {output}, and the input like {input}{both}.",
                four_digits(gain),
                // What is within 0 % nobody believes.
                percent.max(0.1)
            ),
            percent,
            NEAR_PERCENT,
            format!(
                "Multiply the column of the output by {inverse}, so that both are in {input}; or, if that is how it should be, name both units in the \
                 head of the file, as in 'angle [rad]' or 'angle_rad': then the gain has its unit, and is not doubted."
            ),
        )
    })
}

/// Travels of a servo, by the unit of its angle: one that is no winch turns by less than a turn, and strokes of less than a degree are hardly
/// more than its play. Radians are 57 degrees, so that what is outside of one range is far within the other.
const TRAVEL_RAD: f64 = std::f64::consts::TAU;
const TRAVEL_DEG: f64 = 1.0;

/// That the position, whose column names its unit, goes as far as if it were in the other one. Recordings of servoid are in degrees by their rig.
pub(crate) fn advice_on_travel(data: &Dataset) -> Option<Advice> {
    if data.about.us_per_degree.is_some() {
        return None;
    }
    let unit = unit_meant(data.about.units().output?)?;
    let positions = data.record.outputs();
    travel_in_doubt(span(positions)?, &unit)
}

fn travel_in_doubt(travel: f64, unit: &str) -> Option<Advice> {
    let (limit, other, factor) = match unit {
        "rad" if travel > TRAVEL_RAD => (TRAVEL_RAD, "degrees", "0.01745329"),
        "deg" if 0.0 < travel && travel < TRAVEL_DEG => (TRAVEL_DEG, "radians", "57.29578"),
        _ => return None,
    };
    let (shown, in_degrees) = match unit {
        "rad" => (
            "radians",
            format!(", {} degrees", four_digits(travel.to_degrees())),
        ),
        _ => ("degrees", String::new()),
    };
    Some(Advice::new(
        Check::UnitMix,
        format!(
            "The position moves over {} {shown} in all{in_degrees}, by the name of its column, and no usual servo does. In {other} it would be what one does.",
            four_digits(travel)
        ),
        travel,
        limit,
        format!(
            "If the column is in {other}, change its name, or multiply it by {factor}: speeds and the time for 60 degrees follow from it."
        ),
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use servoid_identification::{Options, Record, identify};

    #[test]
    fn a_travel_that_is_none_of_a_servo_is_doubted() {
        let found = |travel, unit| travel_in_doubt(travel, unit).map(|advice| advice.finding);
        let said = found(30.0, "rad").unwrap();
        assert!(
            said.contains("30.00 radians in all, 1719 degrees"),
            "{said}"
        );
        assert!(
            found(0.52, "deg")
                .unwrap()
                .contains("0.5200 degrees in all")
        );
        for (travel, unit) in [(10.0, "deg"), (0.5, "rad"), (300.0, "deg"), (0.5, "V")] {
            assert_eq!(found(travel, unit), None, "{travel} {unit}");
        }
    }

    #[test]
    fn radians_beside_degrees_are_named_and_other_gains_are_not() {
        let levels: Vec<f64> = (0..600).map(|k| f64::from(k / 20 * 7 % 5)).collect();
        let found = |gain: f64, input: Option<&str>, output: Option<&str>| {
            let mut angle = 0.0;
            let mut follow = |level: &f64| {
                angle += 0.3 * (level - angle);
                gain * angle
            };
            let angles: Vec<f64> = levels.iter().map(&mut follow).collect();
            let record = Record::of_run(0.02, &levels, &angles).unwrap();
            let model = identify(&record, &Options::default()).unwrap();
            advice_on_gain(&model, Units { input, output }).map(|advice| advice.finding)
        };
        let (small, large) = (1f64.to_radians(), 1f64.to_degrees());
        let named = found(1.02 * small, Some("deg"), Some("°")).unwrap();
        assert_eq!(
            named,
            "The gain is 0.01780, which is pi/180 within 2.0 %: the output looks like radians, and the input like degrees, \
             though both columns are named deg."
        );
        assert!(found(-large, None, Some("deg")).unwrap().contains("180/pi"));
        assert_eq!(found(small, Some("deg"), Some("rad")), None);
        assert_eq!(found(small, Some("us"), Some("deg")), None);
        assert_eq!(found(1.1 * small, None, None), None);
        assert_eq!(found(1.0, None, None), None);
    }
}
