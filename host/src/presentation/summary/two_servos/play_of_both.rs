//! The play of two servos: which of them is worn.

use crate::data::units::Units;
use crate::presentation::summary::wording::numbers::{digits, digits_beside, four_digits};
use servoid_identification::comparison::{QuantityPair, ServoModelComparison};
use servoid_identification::results::{Interval, with_unit};
use servoid_identification::servo_model::QuantityKind;

fn is_play(pair: &QuantityPair) -> bool {
    pair.kind() == Some(QuantityKind::Play)
}

/// Which servo has more play for sure, or some where the model of the other one has none: that is wear.
pub(super) fn more_play(
    a: &str,
    b: &str,
    found: &ServoModelComparison,
    units: Units<'_>,
) -> Option<String> {
    let (pair, difference) = (found.quantities.iter())
        .zip(&found.bounds.valid()?.differences)
        .find(|(pair, _)| is_play(pair))?;
    let sure = |interval: Option<Interval>| interval?.lower.filter(|lower| *lower > 0.0);
    let (worn, other, of_worn, of_other) = match (pair.a, pair.b) {
        (Some(of_a), Some(of_b)) if difference.is_sure() && of_b > of_a => (b, a, of_b, Some(of_a)),
        (Some(of_a), Some(of_b)) if difference.is_sure() => (a, b, of_a, Some(of_b)),
        (None, Some(of_b)) => sure(difference.b).map(|_| (b, a, of_b, None))?,
        (Some(of_a), None) => sure(difference.a).map(|_| (a, b, of_a, None))?,
        _ => return None,
    };
    let shown = |play: f64| with_unit(four_digits(play), units.output.unwrap_or_default());
    let beside = match of_other {
        Some(play) => format!("{} in {other}", shown(play)),
        None => format!("none that shows in {other}"),
    };
    Some(format!(
        "{worn} has more play, {} beside {beside}: its gears, or what is between them and the sensor, are more worn. Replace it where that is more than its use allows.",
        shown(of_worn)
    ))
}

/// The play of both models, where one of them has no intervals.
pub(super) fn play_of_models(
    a: &str,
    b: &str,
    found: &ServoModelComparison,
    units: Units<'_>,
) -> Option<String> {
    found.bounds.withdrawn()?;
    let pair = found.quantities.iter().find(|pair| is_play(pair))?;
    let unit = units.output.unwrap_or_default();
    let shown = |value: f64, interval: Option<Interval>| {
        let ends = interval.and_then(|interval| Some([interval.lower?, interval.upper?]));
        let value_in_unit = |digits: String| with_unit(digits, unit);
        match ends {
            Some([lower, upper]) => {
                let digits = |number| digits_beside(number, 3, Some(upper - lower));
                format!(
                    "{} ({} .. {})",
                    value_in_unit(digits(value)),
                    digits(lower),
                    digits(upper)
                )
            }
            None => format!("{}, without an interval,", value_in_unit(digits(value, 2))),
        }
    };
    let [of_a, of_b] = [
        shown(pair.a?, pair.interval_of_one.a),
        shown(pair.b?, pair.interval_of_one.b),
    ];
    Some(format!(
        "By the models play is {of_a} in {a} and {of_b} in {b}. More play is wear."
    ))
}
