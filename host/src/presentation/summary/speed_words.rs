//! Speeds of a servo in words: with the time for 60 degrees, and the direction.

use super::numbers::digits;
use super::sixty_degrees::seconds_per_60_degrees;
use crate::data::units::Units;
use servoid_identification::servo_model::{ReachedSpeeds, ServoModel};

/// Upwards, and what that is where the position goes against the command.
pub(super) fn upwards(model: &ServoModel) -> &'static str {
    match model.parameters(0).gain < 0.0 {
        true => "upwards (the position grows, the command falls)",
        false => "upwards",
    }
}

/// "331 deg/s (0.181 s/60°)", of a speed and its figure.
pub(super) fn speed_in_words(
    model: &ServoModel,
    (speed, figure): (f64, String),
    units: Units<'_>,
) -> String {
    let unit = units.output.unwrap_or("units");
    format!("{figure} {unit}/s{}", turn(model, speed, units))
}

/// The standard deviation of a measured speed by the noise of two readings.
pub(super) fn noise_of_speed(model: &ServoModel) -> f64 {
    std::f64::consts::SQRT_2 * model.noise.sigma
        / model.sample_period_s.max(ReachedSpeeds::MEAN_OVER_S)
}

/// By so many standard deviations noise may raise the largest of many measured speeds.
pub(super) const RAISED_BY_NOISE: f64 = 4.0;

/// A measured speed and its figure, without the digits that the noise may have raised.
pub(super) fn measured_speed(model: &ServoModel, speed: f64) -> (f64, String) {
    let step = 10f64.powf((RAISED_BY_NOISE * noise_of_speed(model)).log10().floor());
    let rounded = match step > 0.0 && step < speed {
        true => (speed / step).floor() * step,
        false => speed,
    };
    (rounded, digits(rounded, 2))
}

/// " (0.181 s/60°)", or what that is if the output is in degrees.
fn turn(model: &ServoModel, speed: f64, units: Units<'_>) -> String {
    let stated = seconds_per_60_degrees(speed, units);
    let assumed = || {
        let seconds = seconds_per_60_degrees(speed, assumed_units(model, units)?)?;
        Some(format!("{seconds} if that is degrees"))
    };
    let seconds = stated.or_else(assumed);
    seconds.map_or_else(String::new, |seconds| format!(" ({seconds})"))
}

/// Degrees, where no unit is known and the model takes the command for them.
pub(super) fn assumed_units(model: &ServoModel, units: Units<'_>) -> Option<Units<'static>> {
    let degrees = Some("deg");
    let assumed = Units {
        input: degrees,
        output: degrees,
    };
    (units == Units::default() && model.radians_per_command == 1f64.to_radians()).then_some(assumed)
}
