//! Two servo models beside each other, as text.

use super::layout::wrapped;
use super::numbers::percent;
use super::servo_model::{number, scale_and_unit};
use crate::data::units::Units;
use servoid_identification::comparison::{QuantityDifference, QuantityPair, ServoModelComparison};
use servoid_identification::results::{Bounds, Interval};

/// Quantities that a sentence names at the most; the table has them all.
const NAMED: usize = 4;

/// A sentence on what differs for sure; `a` and `b` are the names of the two.
#[must_use]
pub fn sentence_on_servo_models(
    a: &str,
    b: &str,
    found: &ServoModelComparison,
    units: Units<'_>,
) -> String {
    let bounds = match &found.bounds {
        Bounds::Withdrawn(reason) => {
            return format!(
                "As machines: no statement about the difference, because for at least one of the two {}; the values stand without intervals.",
                reason.because()
            );
        }
        Bounds::Valid(bounds) => bounds,
    };
    let sure: Vec<String> = found
        .quantities
        .iter()
        .zip(&bounds.differences)
        .filter(|(_, difference)| difference.is_sure())
        .filter_map(|(pair, _)| in_words(a, b, pair, units))
        .collect();
    let level = percent(bounds.level);
    let rest = match sure.len() {
        0 => {
            return format!(
                "As machines: no quantity of {a} and {b} is shown to differ ({level} % intervals)."
            );
        }
        count if count > NAMED => format!("; and {} more", count - NAMED),
        _ => String::new(),
    };
    let named: Vec<String> = sure.into_iter().take(NAMED).collect();
    format!(
        "As machines they differ, each quantity by itself at {level} %: {}{rest}.",
        named.join("; ")
    )
}

/// "delay 10.3 ms in A, 12.1 ms in B"
fn in_words(a: &str, b: &str, pair: &QuantityPair, units: Units<'_>) -> Option<String> {
    let (scale, unit) = scale_and_unit(pair.unit, units);
    let shown = |value: f64| {
        format!("{} {unit}", number(scale * value))
            .trim_end()
            .to_owned()
    };
    let (of_a, of_b) = (shown(pair.a?), shown(pair.b?));
    Some(format!("{} {of_a} in {a}, {of_b} in {b}", pair.name))
}

/// Both servos quantity by quantity, with what is sure about their difference.
#[must_use]
pub fn of_servo_models(a: &str, b: &str, found: &ServoModelComparison, units: Units<'_>) -> String {
    let bounds = found.bounds.valid();
    let (difference, below) = match bounds {
        Some(bounds) => (
            "difference",
            format!("{} % intervals below", percent(bounds.level)),
        ),
        None => ("", "no intervals".to_owned()),
    };
    let head = format!("  {below:34} {a:>21} {b:>21} {difference:>21}");
    let mut text = format!("\n{}\n", head.trim_end());
    for (index, pair) in found.quantities.iter().enumerate() {
        let difference = bounds.and_then(|bounds| bounds.differences.get(index));
        text += &rows(pair, difference, units);
    }
    text + &format!("\n  {}\n", wrapped(how_servo_models_are_compared(found), 2))
}

/// The way the differences were computed.
pub(crate) fn how_servo_models_are_compared(found: &ServoModelComparison) -> &'static str {
    match found.bounds {
        Bounds::Valid(_) => {
            "Difference: second less first, from the ends of both intervals: it holds wherever both hold, and is wider than independent \
             recordings would need."
        }
        Bounds::Withdrawn(_) => {
            "Without intervals on both sides nothing is said about the difference."
        }
    }
}

/// The values, and their intervals below them where there are any.
fn rows(pair: &QuantityPair, difference: Option<&QuantityDifference>, units: Units<'_>) -> String {
    let (scale, unit) = scale_and_unit(pair.unit, units);
    let shown = |value: Option<f64>| value.map_or("-".to_owned(), |v| number(scale * v));
    let with_unit = |value: Option<f64>| match value {
        Some(_) => format!("{} {unit}", shown(value)).trim_end().to_owned(),
        None => shown(value),
    };
    let [a, b] = [pair.a, pair.b].map(with_unit);
    let apart = difference.and_then(|found| found.difference);
    let less = apart.map_or_else(String::new, |found| with_unit(found.value));
    let first = format!("  {:34} {a:>21} {b:>21} {less:>21}", pair.name);
    let Some(found) = difference else {
        return format!("{}\n", first.trim_end());
    };
    let ends = |interval: Option<Interval>| match interval {
        Some(Interval {
            lower: None,
            upper: None,
            ..
        })
        | None => String::new(),
        Some(found) => format!("{} .. {}", shown(found.lower), shown(found.upper)),
    };
    let [a, b, less] = [found.a, found.b, apart].map(ends);
    let second = format!("  {:34} {a:>21} {b:>21} {less:>21}", "");
    format!("{}\n{}\n", first.trim_end(), second.trim_end())
}
