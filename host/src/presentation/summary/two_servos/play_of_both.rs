//! The play of two servos: which of them is worn.

use crate::data::units::Units;
use crate::presentation::summary::wording::numbers::{digits, digits_beside, four_digits};
use servoid_identification::comparison::{MorePlay, QuantityPair, ServoModelComparison};
use servoid_identification::results::{Interval, Reason, with_unit};
use servoid_identification::servo_model::{QuantityKind, Spread};

fn is_play(pair: &QuantityPair) -> bool {
    pair.kind() == Some(QuantityKind::Play)
}

/// Which servo has more play for sure, and what that means.
pub(super) fn more_play(
    a: &str,
    b: &str,
    found: &ServoModelComparison,
    units: Units<'_>,
) -> Option<String> {
    let more = found.more_play()?;
    let (worn, other) = if more.is_second { (b, a) } else { (a, b) };
    let shown = |play: f64| with_unit(four_digits(play), units.output.unwrap_or_default());
    let beside = match more.of_other {
        Some(play) => format!("{} in {other}", shown(play)),
        None => format!("none that shows in {other}"),
    };
    Some(format!(
        "{worn} has more play, {} beside {beside}: its gears, or what is between them and the sensor, are more worn. Replace it where that is more than its use allows.",
        shown(more.play)
    ))
}

/// How far the plays of both may differ, where no difference is sure.
pub(super) fn like_play(
    a: &str,
    b: &str,
    found: &ServoModelComparison,
    units: Units<'_>,
) -> Option<String> {
    let differences = &found.bounds.valid()?.differences;
    let mut pairs = found.quantities.iter().zip(differences);
    let (pair, difference) = pairs.find(|(pair, _)| is_play(pair))?;
    let difference = difference.difference.filter(|_| !difference.is_sure())?;
    let [lower, upper] = difference.ends()?;
    let unit = units.output.unwrap_or_default();
    let shown = |value: f64| with_unit(digits_beside(value, 3, Some(upper - lower)), unit);
    Some(format!(
        "No difference of their play is sure: {} in {a} and {} in {b}, which leaves one of up to {}.",
        shown(pair.a?),
        shown(pair.b?),
        with_unit(digits(upper.max(-lower), 2), unit)
    ))
}

/// The play of the models, where one of them has no intervals.
pub(super) fn play_of_models(
    a: &str,
    b: &str,
    found: &ServoModelComparison,
    units: Units<'_>,
) -> Option<String> {
    found.bounds.withdrawn()?;
    let pair = found.quantities.iter().find(|pair| is_play(pair))?;
    let unit = units.output.unwrap_or_default();
    let shown = |value: f64, interval: Option<Interval>, fits: Option<Spread>| {
        let ends = interval.and_then(|interval| interval.ends());
        let value_in_unit = |digits: String| with_unit(digits, unit);
        if let Some([lower, upper]) = ends {
            let digits = |number| digits_beside(number, 3, Some(upper - lower));
            return Some(format!(
                "{} ({} .. {})",
                value_in_unit(digits(value)),
                digits(lower),
                digits(upper)
            ));
        }
        // A figure that other fits have half as large or half as large again says nothing.
        let off = fits?.farthest_from(value);
        (off < value / 2.0).then(|| {
            format!(
                "{}, other fits up to {} away and no interval,",
                value_in_unit(digits(value, 2)),
                digits(off, 2)
            )
        })
    };
    let of = |play: Option<f64>, interval, fits| match play {
        Some(play) => shown(play, interval, fits).map(Some),
        None => Some(None),
    };
    let of_a = of(pair.a, pair.interval_of_one.a, pair.other_fits.a)?;
    let of_b = of(pair.b, pair.interval_of_one.b, pair.other_fits.b)?;
    // A model that lacks something of its servo may have a dead band or a load in place of play.
    let shows = |without_bounds: Option<Reason>, play: f64, rmse: f64| {
        without_bounds.is_none() && MorePlay::would_show(play, rmse)
    };
    let in_words = match (of_a, of_b) {
        (Some(of_a), Some(of_b)) => format!("{of_a} in {a} and {of_b} in {b}"),
        (Some(of_a), None) if shows(found.without_bounds.b, pair.a?, found.rmse.b) => {
            format!("{of_a} in {a}, and none that shows in {b}")
        }
        (None, Some(of_b)) if shows(found.without_bounds.a, pair.b?, found.rmse.a) => {
            format!("{of_b} in {b}, and none that shows in {a}")
        }
        _ => return None,
    };
    Some(format!(
        "By the models play is {in_words}. More play is wear."
    ))
}
