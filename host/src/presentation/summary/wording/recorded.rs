//! What the recording had: beyond it, no model is known to be right.

use super::speed_words::reached_speed;
use crate::data::units::Units;
use servoid_identification::servo_model::{CommandRange, ReachedSpeeds};

/// "from -20.0 to 60.0 deg".
pub(crate) fn range_in_words(range: CommandRange, units: Units<'_>) -> String {
    let size = range.amplitude();
    let [least, largest] = [range.least, range.largest].map(|end| beside(end, size));
    let unit = units
        .input
        .map(|unit| format!(" {unit}"))
        .unwrap_or_default();
    format!("from {least} to {largest}{unit}")
}

/// "40 deg/s upwards and 38 deg/s downwards", which were exceeded, in a `unit` of which there are `each` to one of the position; `None` where
/// no sample surely shows a speed.
pub(crate) fn speeds_in_words(reached: ReachedSpeeds, each: f64, unit: &str) -> Option<String> {
    let directions = [
        (reached.upwards, "upwards"),
        (reached.downwards, "downwards"),
    ];
    let moved = directions.iter().filter(|(speed, _)| *speed > 0.0);
    let each: Vec<String> = moved
        .map(|(speed, direction)| {
            let figure = reached_speed(each * speed).1;
            format!("{figure} {unit}/s {direction}")
        })
        .collect();
    (!each.is_empty()).then(|| each.join(" and "))
}

/// A number with the digits that count beside the size `size`: three of that.
pub(crate) fn beside(value: f64, size: f64) -> String {
    let decimals = 2 - size.abs().max(f64::MIN_POSITIVE).log10().floor() as i32;
    format!("{value:.*}", decimals.clamp(0, 12) as usize)
}
