//! The interval of a quantity, and whether the record determines it.

use super::definition::{Definition, Domain, define};
use super::offset;
use super::quantity::Spread;
use super::quantity_kind::QuantityKind;
use crate::numerics::{dot, not_negative};
use crate::results::Interval;
use crate::servo_model::descent::coordinates::{FRICTION_SPEED_SHARE, Point};
use crate::servo_model::motion::simulated_motion::Fastest;
use crate::servo_model::uncertainty::possible_servo::PossibleServo;
use crate::thresholds::{SERVO_TOP_SPEED_REACHED, UNDETERMINED_RATIO};

/// Ratio of the upper bound to the lower from which on the two exclude nothing.
const SENSELESS: f64 = 1e6;

/// How far a coordinate that the record does not show may be off \[units of the command, or powers of e\]: further than any is.
const FARTHEST_OFF: f64 = 100.0;

/// A ratio of friction at rest to that in motion that does not differ from 1.
const NO_MORE_AT_REST: f64 = 1.05;

/// The smallest interval that holds both; the value is that of the first.
pub(super) fn hull(a: Interval, b: Interval) -> Interval {
    let both = |x: Option<f64>, y: Option<f64>, of: fn(f64, f64) -> f64| Some(of(x?, y?));
    Interval {
        value: a.value,
        lower: both(a.lower, b.lower, f64::min),
        upper: both(a.upper, b.upper, f64::max),
    }
}

impl Definition {
    /// Whether `value` is at the end of what the fit may choose, where without bounds it stands for what the model lacks: a delay of 0, which no servo has, and friction at rest that is that in
    /// motion, which the fit also has of servos in which it is 1.4 times as large.
    pub(super) fn is_at_end(&self, value: f64) -> bool {
        match self.kind {
            QuantityKind::Delay => value <= 0.0,
            QuantityKind::FrictionAtRest => value < NO_MORE_AT_REST,
            _ => false,
        }
    }

    /// Whether it follows from a law that is assumed: how fast friction at rest is gone once the shaft turns. Of a servo in which it is gone at once, 6 of 11 intervals
    /// of the excess at 99 % missed, and all others held. Where friction at rest of `point` is gone at a speed of its own, the law moves the rests, and so
    /// missed 4 of 35 of the offset.
    pub(super) fn is_of_assumed_law(&self, point: &Point) -> bool {
        match self.kind {
            QuantityKind::FrictionAtRest => true,
            QuantityKind::Offset => {
                point.terms.friction && point.friction_speed_share != FRICTION_SPEED_SHARE
            }
            _ => false,
        }
    }

    /// From `value` to those of `others`; one without the term counts as in [`Self::interval`].
    pub(super) fn spread(&self, value: f64, middle: f64, others: &[Point]) -> Spread {
        let without = (self.domain == Domain::NotNegative).then_some(0.0);
        let values = || {
            others
                .iter()
                .filter_map(|point| self.value(point, middle).or(without))
        };
        Spread {
            least: values().fold(value, f64::min),
            most: values().fold(value, f64::max),
        }
    }

    /// The interval by one servo. The output at rest jumps where what pushes the shaft changes its side.
    pub(super) fn interval(
        &self,
        servo: &PossibleServo,
        middle: f64,
        critical: f64,
    ) -> Option<Interval> {
        let own = self.smooth_interval(servo, middle, critical)?;
        let of = |of| {
            let definition = define(self.kind, self.unit, Domain::Any, of);
            definition.smooth_interval(servo, middle, critical)
        };
        if self.kind != QuantityKind::Offset || offset::side_is_known(of) {
            return Some(own);
        }
        Some(offset::EDGES.into_iter().filter_map(of).fold(own, hull))
    }

    /// The same of what is a smooth function of the servo. One without the term says zero where that is what being without it means,
    /// and else nothing.
    fn smooth_interval(
        &self,
        servo: &PossibleServo,
        middle: f64,
        critical: f64,
    ) -> Option<Interval> {
        let Some(value) = self.value(&servo.point, middle) else {
            return (self.domain == Domain::NotNegative).then(|| Interval::new(0.0, 0.0, 0.0));
        };
        let slopes = self.slopes(&servo.point, middle)?;
        let mut variance = 0.0;
        for (i, a) in slopes.iter().enumerate() {
            for (j, b) in slopes.iter().enumerate() {
                variance += a * servo.covariance[(i, j)] * b;
            }
        }
        let hidden = |change: &Vec<f64>| FARTHEST_OFF * dot(&slopes, change);
        let hidden = servo.unseen.iter().map(hidden);
        let half = hidden.fold(critical * not_negative(variance).sqrt(), f64::hypot);
        Some(match self.domain {
            Domain::Any => Interval::new(value, value - half, value + half),
            Domain::NotNegative => Interval::new(value, not_negative(value - half), value + half),
            Domain::OneAndMore => Interval::new(value, (value - half).max(1.0), value + half),
            Domain::Positive => {
                let factor = (half / value).exp();
                Interval::new(value, value / factor, value * factor)
            }
        })
    }

    /// Derivatives by the coordinates, by central differences: they are smooth, and few.
    fn slopes(&self, point: &Point, middle: f64) -> Option<Vec<f64>> {
        let at = |i: usize, change: f64| {
            let mut moved = point.clone();
            moved.values[i] += change;
            self.value(&moved, middle)
        };
        (0..point.values.len())
            .map(|i| {
                let step = 1e-5 * point.values[i].abs().max(1e-3);
                Some((at(i, step)? - at(i, -step)?) / (2.0 * step))
            })
            .collect()
    }

    /// The interval of what the servo nearly did in the record; of anything else, that it can do as much. The upper bound decides:
    /// a value that is too low by chance, and is reached for that reason alone, would pass for determined. Where no bounds hold,
    /// the value is all there is.
    pub(super) fn as_far_as_reached(
        &self,
        interval: Interval,
        holds: bool,
        fastest: &Fastest,
    ) -> Interval {
        let most = if holds {
            interval.upper
        } else {
            interval.value
        };
        match (self.reached, most) {
            (Some(reached), Some(most)) if reached(fastest) < SERVO_TOP_SPEED_REACHED * most => {
                Interval {
                    lower: interval.lower.map(|lower| lower.min(reached(fastest))),
                    upper: None,
                    ..interval
                }
            }
            _ => interval,
        }
    }

    /// Bounds that are farther than [`SENSELESS`] apart exclude nothing: an exponential makes 8e-165 of what is not known.
    pub(super) fn without_senseless_bounds(&self, interval: Interval) -> Interval {
        let bounds = interval.ends();
        let is_wide = bounds.is_some_and(|[lower, upper]| upper > SENSELESS * lower);
        match self.domain == Domain::Positive && is_wide {
            true => interval.without_bounds(),
            false => interval,
        }
    }

    /// Whether an interval says something: what is a ratio is known to a factor of ten, and what has a size to better than the `largest` that
    /// would show in the record, such as the travel.
    pub(super) fn is_determined(&self, interval: &Interval, largest: f64) -> bool {
        let Some([lower, upper]) = interval.ends() else {
            return false;
        };
        let is_known_ratio = upper < UNDETERMINED_RATIO * lower;
        match self.domain {
            Domain::Positive | Domain::OneAndMore => is_known_ratio,
            Domain::NotNegative => upper < largest,
            Domain::Any if self.kind == QuantityKind::Gain => {
                is_known_ratio || -lower < UNDETERMINED_RATIO * -upper
            }
            Domain::Any => upper - lower < largest,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::servo_model::quantities::definition::DEFINITIONS;
    use crate::servo_model::quantities::quantity_kind::QuantityKind;

    #[test]
    fn a_top_speed_is_open_where_its_upper_bound_is_twice_what_was_reached() {
        let kind = QuantityKind::TopSpeedUpwards;
        let top_speed = DEFINITIONS.iter().find(|found| found.kind == kind).unwrap();
        let fastest = Fastest {
            upwards: 60.0,
            downwards: 0.0,
        };
        // Reached is more than half of the value, and less than half of what it may be.
        let wide = Interval::new(100.0, 80.0, 125.0);
        let open = top_speed.as_far_as_reached(wide, true, &fastest);
        assert_eq!((open.lower, open.upper), (Some(60.0), None));
        let known = top_speed.as_far_as_reached(Interval::new(100.0, 90.0, 111.0), true, &fastest);
        assert_eq!((known.lower, known.upper), (Some(90.0), Some(111.0)));
        let is_determined = |interval| top_speed.is_determined(interval, f64::INFINITY);
        assert!(!is_determined(&open) && is_determined(&known));
        assert_eq!(top_speed.as_far_as_reached(wide, false, &fastest), wide);
    }

    #[test]
    fn a_ratio_of_friction_that_may_be_anything_is_not_determined() {
        let kind = QuantityKind::FrictionAtRest;
        let ratio = DEFINITIONS.iter().find(|found| found.kind == kind).unwrap();
        assert!(!ratio.is_determined(&Interval::new(196.0, 1.0, 78_627.0), 1.0));
        assert!(ratio.is_determined(&Interval::new(1.5, 1.0, 2.1), 1.0));
    }

    #[test]
    fn what_may_be_larger_than_the_travel_is_not_determined() {
        let is_determined = |kind, lower, upper, largest| {
            let found = DEFINITIONS.iter().find(|found| found.kind == kind).unwrap();
            found.is_determined(&Interval::new(lower, lower, upper), largest)
        };
        // Of a recording between -15 and 15 degrees.
        let friction = QuantityKind::RestingError;
        assert!(!is_determined(friction, 0.0, 2089.0, 30.0));
        assert!(is_determined(friction, 0.0, 0.5, 30.0));
        assert!(!is_determined(
            QuantityKind::FrictionOfGears,
            0.0,
            6.53,
            1.0
        ));
        assert!(is_determined(QuantityKind::FrictionOfGears, 0.0, 0.02, 1.0));
        assert!(!is_determined(QuantityKind::Offset, -2940.0, 2940.0, 30.0));
        assert!(is_determined(QuantityKind::Offset, -0.1, 0.1, 30.0));
        for (lower, upper, known) in [
            (-38.3, 41.1, false),
            (0.05, 2.0, false),
            (0.96, 1.05, true),
            (-1.1, -0.9, true),
        ] {
            assert_eq!(
                is_determined(QuantityKind::Gain, lower, upper, f64::INFINITY),
                known
            );
        }
    }

    #[test]
    fn a_bound_that_excludes_nothing_is_none() {
        let kind = QuantityKind::DampingRatio;
        let damping = DEFINITIONS.iter().find(|found| found.kind == kind).unwrap();
        let cut = |lower, upper| {
            let found = damping.without_senseless_bounds(Interval::new(0.5, lower, upper));
            (found.lower, found.upper)
        };
        assert_eq!(cut(8e-165, 1e80), (None, None));
        assert_eq!(cut(0.1, 40.0), (Some(0.1), Some(40.0)));
    }
}
