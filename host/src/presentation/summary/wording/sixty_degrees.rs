//! How fast a servo turns by 60 degrees, as data sheets state it.

use crate::data::units::Units;
use servoid_identification::servo_model::{Quantity, ServoModel, Unit};

/// A speed that the record determines, as the time for 60 degrees, which data sheets give.
pub(crate) fn per_60_degrees(quantity: &Quantity, units: Units<'_>) -> Option<String> {
    let is_speed = quantity.unit == Unit::OutputPerSecond && quantity.determined;
    is_speed.then(|| seconds_per_60_degrees(quantity.value, units))?
}

/// "0.148 s/60°" of a speed; `None` where the output is not known to be an angle.
pub(crate) fn seconds_per_60_degrees(speed: f64, units: Units<'_>) -> Option<String> {
    turn_time_s(speed, units).map(|seconds| format!("{seconds:.3} s/60°"))
}

/// The time for 60 degrees \[s\]; `None` where the output is not known to be an angle.
pub(crate) fn turn_time_s(speed: f64, units: Units<'_>) -> Option<f64> {
    let turn = sixty_degrees(units)?;
    (speed > 0.0).then(|| turn / speed)
}

/// 60 degrees in units of the output, where that is an angle.
pub(crate) fn sixty_degrees(units: Units<'_>) -> Option<f64> {
    match units.output? {
        "deg" | "°" | "degree" | "degrees" => Some(60.0),
        "rad" => Some(60f64.to_radians()),
        _ => None,
    }
}

/// The times of a stroke of 60 degrees up and down in whole milliseconds, where the model can say it.
pub(crate) fn stroke_of_60_degrees_ms(model: &ServoModel, units: Units<'_>) -> Option<[String; 2]> {
    let times_s = model.stroke_times_s(sixty_degrees(units)?)?;
    Some(times_s.map(whole_ms))
}

/// A time in whole milliseconds.
pub(crate) fn whole_ms(time_s: f64) -> String {
    format!("{:.0}", 1e3 * time_s)
}

/// "239 ms upwards and 171 ms downwards"
pub(crate) fn both_ways([up_s, down_s]: [f64; 2]) -> String {
    let [up, down] = [up_s, down_s].map(whole_ms);
    match up == down {
        true => format!("{up} ms"),
        false => format!("{up} ms upwards and {down} ms downwards"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use servoid_identification::results::{Bounds, Interval};

    #[test]
    fn a_speed_is_a_time_where_the_output_is_an_angle() {
        let speed = Quantity {
            name: "top speed upwards".to_owned(),
            unit: Unit::OutputPerSecond,
            determined: true,
            value: 400.0,
            interval: Bounds::Valid(Interval::new(400.0, 390.0, 410.0)),
            other_fits: None,
        };
        let degrees = Units {
            input: Some("deg"),
            output: Some("deg"),
        };
        assert_eq!(
            per_60_degrees(&speed, degrees).as_deref(),
            Some("0.150 s/60°")
        );
        assert_eq!(per_60_degrees(&speed, Units::default()), None);
    }
}
