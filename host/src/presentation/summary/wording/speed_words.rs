//! Speeds of a servo in words: with the time for 60 degrees, and the direction.

use super::numbers::digits;
use super::sixty_degrees::{seconds_per_60_degrees, turn_time_s};
use crate::data::units::Units;
use servoid_identification::servo_model::ServoModel;

/// Upwards, and what that is where the position goes against the command.
pub(crate) fn upwards(model: &ServoModel) -> &'static str {
    match model.parameters(0).gain < 0.0 {
        true => "upwards (the position grows, the command falls)",
        false => "upwards",
    }
}

/// "331 deg/s (0.181 s/60°)", of a speed and its figure.
pub(crate) fn speed_in_words(
    model: &ServoModel,
    (speed, figure): (f64, String),
    units: Units<'_>,
) -> String {
    with_turn(&figure, turn(model, speed, units), units)
}

/// "240 to 566 deg/s (0.106 to 0.250 s/60°)", of a speed that is known between these.
pub(crate) fn speeds_between_in_words([lower, upper]: [f64; 2], units: Units<'_>) -> String {
    let turns = turn_time_s(upper, units).zip(turn_time_s(lower, units));
    let turns = turns.map(|(quick, slow)| format!("{quick:.3} to {slow:.3} s/60°"));
    let figure = format!("{} to {}", digits(lower, 3), digits(upper, 3));
    with_turn(&figure, turns, units)
}

/// "more than 170 deg/s (less than 0.353 s/60°)", of a speed that was reached at least.
pub(crate) fn reached_in_words(model: &ServoModel, speed: f64, units: Units<'_>) -> String {
    let (speed, figure) = reached_speed(speed);
    let turn = turn(model, speed, units).map(|seconds| format!("less than {seconds}"));
    format!("more than {}", with_turn(&figure, turn, units))
}

/// [`speed_in_words`] of a recording in which no model is asked: without the time for 60 degrees where the unit is not known.
pub(crate) fn measured_speed_in_words((speed, figure): (f64, String), units: Units<'_>) -> String {
    with_turn(&figure, seconds_per_60_degrees(speed, units), units)
}

fn with_turn(figure: &str, turn: Option<String>, units: Units<'_>) -> String {
    let unit = units.output.unwrap_or("units");
    let turn = turn.map_or_else(String::new, |seconds| format!(" ({seconds})"));
    format!("{figure} {unit}/s{turn}")
}

/// A speed that was reached at least, and its figure: two digits, none of which says more than the recording.
pub(crate) fn reached_speed(speed: f64) -> (f64, String) {
    let step = 10f64.powf(speed.log10().floor() - 1.0);
    let rounded = match speed > 0.0 {
        // What is a number of two digits stays the one that it is.
        true => (speed / step * (1.0 + f64::EPSILON)).floor() * step,
        false => 0.0,
    };
    (rounded, digits(rounded, 2))
}

/// "0.181 s/60°", or what that is if the output is in degrees.
fn turn(model: &ServoModel, speed: f64, units: Units<'_>) -> Option<String> {
    let stated = seconds_per_60_degrees(speed, units);
    let assumed = || {
        let seconds = seconds_per_60_degrees(speed, assumed_units(model, units)?)?;
        Some(format!("{seconds} if that is degrees"))
    };
    stated.or_else(assumed)
}

/// Degrees, where no unit is known and the model takes the command for them.
pub(crate) fn assumed_units(model: &ServoModel, units: Units<'_>) -> Option<Units<'static>> {
    let degrees = Some("deg");
    let assumed = Units {
        input: degrees,
        output: degrees,
    };
    (units == Units::default() && model.radians_per_command == 1f64.to_radians()).then_some(assumed)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_speed_that_was_reached_is_never_rounded_up() {
        let figure = |speed| reached_speed(speed).1;
        assert_eq!(figure(1607.1), "1600");
        assert_eq!(figure(289.9), "280");
        assert_eq!(figure(57.0), "57");
        assert_eq!(figure(0.0159), "0.015");
        assert_eq!(figure(0.0), "0");
    }
}
