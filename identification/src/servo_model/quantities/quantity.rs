//! A number about the servo, with its unit and interval.

use super::quantity_kind::QuantityKind;
use crate::results::{Bounds, Interval};
use serde::{Deserialize, Serialize};

/// The unit of a quantity, in terms of the units of command and output of the record.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Unit {
    /// Seconds.
    Seconds,
    /// Hertz.
    Hertz,
    /// No unit.
    One,
    /// Output for each unit of the command.
    OutputPerCommand,
    /// The unit of the command.
    Command,
    /// The unit of the output.
    Output,
    /// The unit of the output for each second.
    OutputPerSecond,
    /// The unit of the output for each second, squared.
    OutputPerSecondSquared,
}

/// A number about the servo.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Quantity {
    /// What it is, in the words of the glossary.
    pub name: String,
    /// Its unit.
    pub unit: Unit,
    /// Whether the record determines it. If not, its interval says what the record leaves open, and `value` is one
    /// number among many.
    pub determined: bool,
    /// Best estimate.
    pub value: f64,
    /// Lower and upper bound, where bounds hold; a missing bound excludes nothing.
    #[serde(flatten)]
    pub interval: Bounds<Interval>,
    /// How far other fits to the record go apart, where no interval can be given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub other_fits: Option<Spread>,
}

/// The least and the most of a quantity among fits to the same record: this one, those with other terms that predict as well, and those
/// to each quarter of the record alone. Not an interval: no level says how often the truth is inside.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Spread {
    /// The least.
    pub least: f64,
    /// The most.
    pub most: f64,
}

impl Spread {
    /// How far the farther end is from `value`: by how much that is off, nobody knows.
    #[must_use]
    pub fn farthest_from(self, value: f64) -> f64 {
        (value - self.least).abs().max((self.most - value).abs())
    }
}

impl Quantity {
    /// Which quantity it is; `None` of one that this version does not know.
    #[must_use]
    pub fn kind(&self) -> Option<QuantityKind> {
        QuantityKind::named(&self.name)
    }
}

/// Allows for output that was recorded up to `seconds` earlier or later than it is taken for: the delay alone is a time from the edge of a
/// command.
pub(crate) fn widen_delay(quantities: &mut [Quantity], seconds: f64) {
    let is_delay = |found: &&mut Quantity| found.kind() == Some(QuantityKind::Delay);
    for quantity in quantities.iter_mut().filter(is_delay) {
        let interval = quantity.interval;
        quantity.interval = interval.map(|found| found.widened(seconds));
        quantity.other_fits = quantity.other_fits.map(|found| Spread {
            least: (found.least - seconds).max(0.0),
            most: found.most + seconds,
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::results::Reason;

    #[test]
    fn the_delay_alone_is_wider_and_only_where_bounds_hold() {
        let quantity = |name: &str, interval| Quantity {
            name: name.to_owned(),
            unit: Unit::Seconds,
            determined: true,
            value: 0.02,
            interval,
            other_fits: None,
        };
        let found = Interval::new(0.02, 0.019, 0.021);
        let withdrawn = Bounds::Withdrawn(Reason::ErrorsNotNoise);
        let mut quantities = [
            quantity("delay", Bounds::Valid(found)),
            quantity("rise time", Bounds::Valid(found)),
            quantity("delay", withdrawn),
        ];
        widen_delay(&mut quantities, 0.005);
        let [delay, other, none] = quantities.map(|quantity| quantity.interval);
        let wider = delay.into_valid().unwrap();
        assert!((wider.lower.unwrap() - 0.014).abs() < 1e-12, "{wider:?}");
        assert!((wider.upper.unwrap() - 0.026).abs() < 1e-12, "{wider:?}");
        assert_eq!((other, none), (Bounds::Valid(found), withdrawn));
    }
}
