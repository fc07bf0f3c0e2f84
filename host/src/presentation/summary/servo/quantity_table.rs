//! The quantities of a servo model as the rows of a table.

use crate::data::units::Units;
use crate::presentation::summary::wording::numbers::{
    WORTH_PRINTING, digits, digits_beside, head_of_bounds,
};
use crate::presentation::summary::wording::sixty_degrees::per_60_degrees;
use servoid_identification::results::{Bounds, Interval, with_unit};
use servoid_identification::servo_model::{Quantity, QuantityKind, Spread, Unit};

/// The table of quantities with its head. Of those that `may_be_extrapolated`, it says so.
pub(crate) fn quantities(
    all: &[Quantity],
    level: Bounds<f64>,
    units: Units<'_>,
    may_be_extrapolated: impl Fn(&Quantity) -> bool,
) -> String {
    let head = head_of_bounds(level);
    let mut text = format!("  {:34} {:>12} {:8} {head}\n", "", "value", "");
    let rows = quantity_rows(all, units).into_iter();
    text.extend(rows.map(|(quantity, found)| {
        let turn = per_60_degrees(quantity, units).map(|turn| format!("= {turn}"));
        let extrapolated = may_be_extrapolated(quantity).then(|| "perhaps extrapolated".to_owned());
        let beside: Vec<String> = turn.into_iter().chain(extrapolated).collect();
        row(&found, &beside.join(", "))
    }));
    text
}

/// Said of a quantity that the record leaves open.
const NOT_DETERMINED: &str = "not determined by this recording";

/// What is said of quantities that depend on a load, where there is one among the kinds `all`: speeds and accelerations are those under the load in the middle of the
/// commands, and friction holds the shaft less far without the load where gears have a part of it.
pub(crate) fn under_load(
    kind: Option<QuantityKind>,
    all: impl Iterator<Item = QuantityKind>,
) -> Option<&'static str> {
    use QuantityKind::{
        AccelerationDownwards, AccelerationUpwards, FrictionOfGears, RestingError,
        TopSpeedDownwards, TopSpeedUpwards,
    };
    let all: Vec<QuantityKind> = all.collect();
    let has_load = all.iter().any(|kind| QuantityKind::OF_LOAD.contains(kind));
    match kind? {
        TopSpeedUpwards | TopSpeedDownwards | AccelerationUpwards | AccelerationDownwards => {
            has_load.then_some("under load")
        }
        RestingError => (has_load && all.contains(&FrictionOfGears)).then_some("without the load"),
        _ => None,
    }
}

/// A quantity as a row of a table.
pub(crate) struct QuantityRow {
    /// What it is.
    pub name: String,
    /// The number; "-" where the record does not determine it.
    pub value: String,
    /// The unit that people use.
    pub unit: String,
    /// Its interval, or that the record does not determine it; without intervals, how far other fits are from the value.
    pub interval: String,
}

impl QuantityRow {
    /// "delay 21.60 ms (21.10 .. 22.04)".
    pub(crate) fn in_words(&self) -> String {
        let value = format!("{} {} {}", self.name, self.value, self.unit);
        match self.interval.is_empty() {
            true => value.trim_end().to_owned(),
            false => format!("{} ({})", value.trim_end(), self.interval),
        }
    }
}

/// The quantities of a servo as rows.
pub(crate) fn quantity_rows<'q>(
    all: &'q [Quantity],
    units: Units<'_>,
) -> Vec<(&'q Quantity, QuantityRow)> {
    let row = |quantity: &'q Quantity| {
        let load = under_load(quantity.kind(), all.iter().filter_map(Quantity::kind));
        let name = match load {
            Some(load) => format!("{}, {load}", quantity.name),
            None => quantity.name.clone(),
        };
        let row = quantity_row(quantity, units);
        (quantity, QuantityRow { name, ..row })
    };
    all.iter().map(row).collect()
}

/// A quantity in the units that people use.
fn quantity_row(quantity: &Quantity, units: Units<'_>) -> QuantityRow {
    let (scale, unit) = scale_and_unit(quantity.unit, units);
    let width = |least: f64, most: f64| scale * (most - least);
    let known = quantity.interval.valid();
    let known = known.and_then(Interval::ends);
    let fits = quantity.other_fits;
    let fits = fits.map(|Spread { least, most }| width(least, most));
    // How sure the last digits are is not known without an interval.
    let shown = |value: f64| match quantity.interval.valid() {
        Some(_) => digits_beside(scale * value, 4, known.map(|[low, high]| width(low, high))),
        None => digits_beside(scale * value, 3, fits),
    };
    let interval = quantity
        .interval
        .valid()
        .map(|found| match quantity.determined {
            true => ends(found, shown),
            false => left_open(found, shown, &unit),
        });
    let value = match quantity.determined {
        true => shown(quantity.value),
        false => "-".to_owned(),
    };
    let spread = quantity.other_fits.filter(|_| quantity.determined);
    let spread = spread.and_then(|fits| of_other_fits(scale * fits.farthest_from(quantity.value)));
    QuantityRow {
        name: quantity.name.clone(),
        value,
        // A unit beside no number would read as one.
        unit: if quantity.determined {
            unit
        } else {
            String::new()
        },
        interval: interval
            .or(spread)
            .unwrap_or_default()
            .trim_end()
            .to_owned(),
    }
}

/// How far away other fits are, as a number that nobody takes for an end of an interval, nor for the least error: "other fits up to 0.31 away". Nothing where there is no other fit.
pub(crate) fn of_other_fits(off: f64) -> Option<String> {
    (off > 0.0).then(|| format!("other fits up to {} away", digits(off, 2)))
}

/// The ends of the interval of a quantity that the record determines.
fn ends(found: &Interval, shown: impl Fn(f64) -> String) -> String {
    let end = |bound: Option<f64>| bound.map_or("-".to_owned(), &shown);
    match (found.lower, found.upper) {
        (None, None) => String::new(),
        (lower, upper) => format!("{} .. {}", end(lower), end(upper)),
    }
}

/// That the record leaves a quantity open, and what its interval excludes all the same.
fn left_open(found: &Interval, shown: impl Fn(f64) -> String, unit: &str) -> String {
    let excluded = match (found.lower, found.upper) {
        (Some(lower), None) if lower > 0.0 => {
            Some(format!("{} or more", with_unit(shown(lower), unit)))
        }
        (Some(lower), Some(upper)) if upper < WORTH_PRINTING * lower => {
            let range = format!("{} .. {}", shown(lower), shown(upper));
            Some(with_unit(range, unit))
        }
        _ => None,
    };
    match excluded {
        Some(excluded) => format!("{NOT_DETERMINED}: {excluded}"),
        None => NOT_DETERMINED.to_owned(),
    }
}

/// A line, with what is said `beside` the interval.
fn row(row: &QuantityRow, beside: &str) -> String {
    let QuantityRow {
        name,
        value,
        unit,
        interval,
    } = row;
    let line = format!("  {name:34} {value:>12} {unit:8} {interval}  {beside}");
    format!("{}\n", line.trim_end())
}

/// Factor to the unit that people use, and its name.
pub(crate) fn scale_and_unit(unit: Unit, units: Units<'_>) -> (f64, String) {
    let output = units.output.unwrap_or("");
    let some_output = units.output.unwrap_or("units");
    match unit {
        Unit::Seconds => (1e3, "ms".to_owned()),
        Unit::Hertz => (1.0, "Hz".to_owned()),
        Unit::One => (1.0, String::new()),
        Unit::OutputPerCommand => (1.0, units.gain().unwrap_or_default()),
        Unit::Command => (1.0, units.input.unwrap_or("").to_owned()),
        Unit::Output => (1.0, output.to_owned()),
        Unit::OutputPerSecond => (1.0, format!("{some_output}/s")),
        Unit::OutputPerSecondSquared => (1.0, format!("{some_output}/s2")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn speeds_and_accelerations_say_that_they_are_under_load() {
        let names = |load: Option<&str>| -> Vec<String> {
            let all = ["top speed upwards", "acceleration upwards", "gain"];
            let all: Vec<Quantity> = (all.into_iter().chain(load))
                .map(|name| quantity(name, true, 390.0, 410.0))
                .collect();
            let rows = quantity_rows(&all, Units::default()).into_iter();
            rows.map(|(_, row)| row.name).collect()
        };
        let loaded = names(Some("load at the middle"));
        assert_eq!(
            loaded[..3],
            [
                "top speed upwards, under load",
                "acceleration upwards, under load",
                "gain"
            ]
        );
        assert_eq!(
            names(None),
            ["top speed upwards", "acceleration upwards", "gain"]
        );
        let gears = |load: &str| {
            let all = ["resting error by friction", "friction of the gears", load];
            let all = all.map(|name| quantity(name, true, 0.1, 0.2));
            quantity_rows(&all, Units::default())[0].1.name.clone()
        };
        assert_eq!(
            gears("load at the middle"),
            "resting error by friction, without the load"
        );
        assert_eq!(gears("gain"), "resting error by friction");
    }

    fn quantity(name: &str, determined: bool, lower: f64, upper: f64) -> Quantity {
        Quantity {
            name: name.to_owned(),
            unit: Unit::OutputPerSecond,
            determined,
            value: 400.0,
            interval: Bounds::Valid(Interval::new(400.0, lower, upper)),
            other_fits: None,
        }
    }

    #[test]
    fn what_is_not_determined_has_no_senseless_interval() {
        let degrees = Units {
            input: Some("deg"),
            output: Some("deg"),
        };
        let absurd = quantity("damping ratio", false, 3e-19, 8e19);
        let row = quantity_row(&absurd, degrees);
        assert_eq!((row.value.as_str(), row.unit.as_str()), ("-", ""));
        assert_eq!(row.interval, "not determined by this recording");
        let open = quantity("top speed upwards", false, 210.0, f64::NAN);
        assert_eq!(
            quantity_row(&open, degrees).interval,
            "not determined by this recording: 210.0 deg/s or more"
        );
    }
}
