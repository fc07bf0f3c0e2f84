//! Quantities of two servos at one angle.
//!
//! Under a load that changes with the angle, top speed, acceleration, the load itself and what follows from its growth are those at the middle of the commands of
//! a record. Of two records with other middles they differ for one and the same servo. What the one side would have at the middle of the other, its
//! estimate says, and not how sure that is: the difference contains all from no such shift to twice as much.

use crate::results::Interval;
use crate::servo_model::{QuantityKind, ServoModel};

/// What a quantity of both differs by, by their angles alone \[unit of the quantity\]: the less of the two shifts that bring it to one angle. 0 of what does not depend on the angle.
pub(super) fn by_angles(kind: QuantityKind, [a, b]: [&ServoModel; 2]) -> Option<f64> {
    let of = |own: &ServoModel, other: &ServoModel| {
        let there = own.quantity_at(kind, angle_of_middle(own, other)?)?;
        Some(there - own.quantity_at(kind, own.commands?.middle())?)
    };
    let shifts = [of(a, b).map(|shift| -shift), of(b, a)];
    let known = shifts.into_iter().flatten();
    known.min_by(|a, b| a.abs().total_cmp(&b.abs()))
}

/// The angle of `own` at the output where `other` has the middle of its commands.
fn angle_of_middle(own: &ServoModel, other: &ServoModel) -> Option<f64> {
    let [here, there] = [own, other].map(|model| model.parameters(0));
    let output = there.gain * other.commands?.middle() + there.offset;
    Some((output - here.offset) / here.gain)
}

/// The `difference` with what the angles make of it: from none of `shift` to twice as much.
pub(super) fn with_shift(difference: Interval, shift: f64) -> Interval {
    difference.reaching((-2.0 * shift).max(0.0), (2.0 * shift).max(0.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_difference_contains_no_shift_and_twice_as_much() {
        let ends = |shift: f64| {
            let found = with_shift(Interval::new(-44.0, -46.0, -42.0), shift);
            (found.lower.unwrap(), found.upper.unwrap())
        };
        assert_eq!(ends(0.0), (-46.0, -42.0));
        assert_eq!(ends(43.0), (-46.0, 44.0));
        assert_eq!(ends(-1.0), (-48.0, -42.0));
    }
}
