//! What the low-order model of a band says, in words.

use super::first_finding::first_finding;
use crate::data::units::Units;
use crate::presentation::summary::wording::numbers::{digits, digits_beside, four_digits, percent};
use servoid_identification::flight_model::FlightModel;
use servoid_identification::results::{Interval, Model, with_unit};

/// The low-order model of a band, where the data do not reject its order: of another order, the gain at rest may be any.
fn of_its_order(flight: &FlightModel) -> Option<[f64; 2]> {
    flight.band_hz.filter(|_| !flight.approximation)
}

/// Gain and shape in a sentence, and what they rest on; `None` of a model of more than a band, of an approximation, and where a finding on the `linear` model of the same record
/// comes first.
pub(crate) fn low_order_sentence(
    flight: &FlightModel,
    linear: &Model,
    units: Units<'_>,
) -> Option<String> {
    let [from, to] = of_its_order(flight).filter(|_| first_finding(linear).is_none())?;
    let gain = units.gain().unwrap_or_default();
    let rows = [
        ("gain", &*gain, 1.0, Some(flight.gain)),
        ("delay", "ms", 1e3, Some(flight.delay_s)),
        ("natural frequency", "rad/s", 1.0, flight.omega_rad_s),
        ("damping ratio", "", 1.0, flight.damping),
        ("lag", "ms", 1e3, flight.lag_s),
    ];
    let (mut known, mut open) = (Vec::new(), Vec::new());
    for (name, unit, scale, interval) in rows {
        let Some(interval) = interval else {
            continue;
        };
        match value_and_interval(&interval, scale) {
            Some(_) if name == "delay" && interval.value < Some(0.0) => {
                known.push(below_zero(&interval));
            }
            Some((value, interval)) => {
                let value = with_unit(&value, unit);
                known.push(format!("a {name} of {value} ({interval})"));
            }
            None => open.push(name),
        }
    }
    let (last, before) = known.split_last()?;
    let known = match before {
        [] => last.clone(),
        _ => format!("{}, and {last}", before.join(", ")),
    };
    let open = match open.is_empty() {
        true => String::new(),
        false => format!(
            " The recording does not determine its {}.",
            open.join(" and ")
        ),
    };
    let level = flight.bounds.valid()?.level;
    Some(format!(
        "A servo of order {} fits from {} to {} Hz; if it has at most three poles, and is the same below and above, it has {known}, with {} % confidence in each.{open}",
        flight.order,
        digits(from, 2),
        digits(to, 3),
        percent(level)
    ))
}

/// The gain of the low-order model with its unit, and its interval and what that rests on.
pub(crate) fn gain_by_order(flight: &FlightModel, units: Units<'_>) -> Option<(String, String)> {
    of_its_order(flight)?;
    let gain = units.gain().unwrap_or_default();
    let (value, interval) = value_and_interval(&flight.gain, 1.0)?;
    let below = format!("{interval}, if it has at most three poles");
    Some((with_unit(&value, &gain), below))
}

/// Of a delay that was fitted below zero, where no servo has one.
fn below_zero(delay: &Interval) -> String {
    let in_ms = |seconds: f64| four_digits(1e3 * seconds);
    let fitted = in_ms(delay.value.unwrap_or(f64::NAN));
    match delay.upper.filter(|upper| *upper > 0.0) {
        Some(upper) => format!(
            "a delay of at most {} ms (fitted as {fitted} ms)",
            in_ms(upper)
        ),
        None => format!(
            "no delay (fitted as {fitted} ms, as if it moved before its command: commands and positions have other times than the file says)"
        ),
    }
}

/// "0.950", "0.949 .. 0.951".
fn value_and_interval(interval: &Interval, scale: f64) -> Option<(String, String)> {
    let [value, lower, upper] = [interval.value?, interval.lower?, interval.upper?];
    let shown = |number: f64| digits_beside(scale * number, 4, Some(scale * (upper - lower)));
    Some((
        shown(value),
        format!("{} .. {}", shown(lower), shown(upper)),
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_delay_below_zero_is_none() {
        let of = |value, lower, upper| below_zero(&Interval::new(value, lower, upper));
        let may_be = of(-0.0021, -0.008, 0.0043);
        assert!(
            may_be.starts_with("a delay of at most 4.300 ms"),
            "{may_be}"
        );
        assert!(of(-0.0021, -0.0031, -0.0011).starts_with("no delay (fitted as -2.100 ms"));
    }
}
