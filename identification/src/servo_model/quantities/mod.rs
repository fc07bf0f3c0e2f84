//! What people ask of a servo, with intervals.

mod definition;
mod interval;
pub(super) mod limit_at_work;
pub(super) mod offset;
mod quantity;
pub(super) mod quantity_kind;

use crate::results::Bounds;
use crate::servo_model::descent::coordinates::Point;
use crate::servo_model::motion::simulated_motion::ServoMotion;
use crate::servo_model::uncertainty::possible_servo::PossibleServo;
use definition::{DEFINITIONS, Definition};
use interval::hull;
use quantity_kind::QuantityKind;
use servoid_dynamics::ServoParameters;

pub(crate) use quantity::widen_delay;
pub use quantity::{Quantity, Spread, Unit};

/// The quantities of the first of `possible`, without the offset where commands are far from 0 under a load that changes with the angle, with intervals that hold those of all, where bounds hold; elsewhere with those of `others`.
/// No delay beyond `longest_delay_s` was looked for.
pub(super) fn quantities(
    possible: &[PossibleServo],
    (critical, longest_delay_s): (f64, f64),
    level: &Bounds<f64>,
    motion: &ServoMotion,
    others: &[Point],
) -> Vec<Quantity> {
    let middle = motion.commands.middle();
    let commands = 2.0 * motion.commands.amplitude();
    let first = possible[0].point.physics(0, |_, value| value);
    let gain = first.gain;
    let largest_of = |unit: Unit| match unit {
        Unit::Command => commands,
        Unit::Output => commands * gain.abs(),
        // What the gears hold of themselves leaves nothing to turn them.
        Unit::One => 1.0,
        Unit::Seconds => longest_delay_s,
        _ => f64::INFINITY,
    };
    // Under a load that changes with the angle, where the servo would rest far from all commands is no matter of them.
    let has_offset = motion.commands.contains(0.0) || !first.load.changes_with_angle();
    let of = |definition: &Definition| {
        if definition.kind == QuantityKind::Offset && !has_offset {
            return None;
        }
        let value = definition.value(&possible[0].point, middle)?;
        let hull = possible
            .iter()
            .filter_map(|servo| definition.interval(servo, middle, critical))
            .reduce(hull)?;
        // What no possible servo has was not asked of the record: that it is nothing is no finding.
        if hull.lower == Some(0.0) && hull.upper == Some(0.0) {
            return None;
        }
        let hull = definition.without_senseless_bounds(hull);
        let hull = match level.valid().is_some() && definition.is_of_assumed_law(&possible[0].point)
        {
            true => hull.without_bounds(),
            false => hull,
        };
        let interval = definition.as_far_as_reached(hull, level.valid().is_some(), &motion.fastest);
        let other_fits = level
            .withdrawn()
            .map(|_| definition.spread(value, middle, others));
        // Where fits disagree on it by as much as it is, play or a wait is in some and not in others.
        let is_vague = definition.kind == QuantityKind::Delay
            && other_fits.is_some_and(|fits| fits.most - fits.least > value);
        Some(Quantity {
            name: definition.kind.name().to_owned(),
            unit: definition.unit,
            determined: definition.is_determined(&interval, largest_of(definition.unit))
                && !(level.valid().is_none() && definition.is_at_end(value))
                && !is_vague,
            value,
            interval: level.as_ref().map(|_| interval),
            other_fits,
        })
    };
    DEFINITIONS.iter().filter_map(of).collect()
}

/// The quantity `kind` of `servo`, `middle` being that of the commands; `None` of a servo that has none.
pub(super) fn value(kind: QuantityKind, servo: &ServoParameters, middle: f64) -> Option<f64> {
    let definition = DEFINITIONS.iter().find(|found| found.kind == kind)?;
    (definition.of)(servo, middle)
}

/// The names of all quantities.
#[cfg(test)]
pub(super) fn names() -> impl Iterator<Item = &'static str> {
    DEFINITIONS.iter().map(|definition| definition.kind.name())
}

/// The quantities of a servo under commands about `middle` by name, without intervals.
#[cfg(test)]
pub(super) fn values(point: &Point, middle: f64) -> Vec<(&'static str, f64)> {
    let of = |definition: &Definition| {
        let value = definition.value(point, middle)?;
        Some((definition.kind.name(), value))
    };
    DEFINITIONS.iter().filter_map(of).collect()
}
