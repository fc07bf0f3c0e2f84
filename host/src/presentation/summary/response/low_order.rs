//! What the low-order model of a band says, in words.

use super::first_finding::first_finding;
use crate::data::units::Units;
use crate::presentation::summary::wording::numbers::{digits, digits_beside, percent};
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

/// "0.950", "0.949 .. 0.951".
fn value_and_interval(interval: &Interval, scale: f64) -> Option<(String, String)> {
    let [value, lower, upper] = [interval.value?, interval.lower?, interval.upper?];
    let shown = |number: f64| digits_beside(scale * number, 4, Some(scale * (upper - lower)));
    Some((
        shown(value),
        format!("{} .. {}", shown(lower), shown(upper)),
    ))
}
