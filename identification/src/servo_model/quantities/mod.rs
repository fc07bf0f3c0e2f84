//! What people ask of a servo, with intervals.

pub(super) mod limit_at_work;
pub(super) mod offset;
pub(super) mod quantity_kind;

use crate::numerics::{dot, not_negative};
use crate::results::{Bounds, Interval};
use crate::servo_model::descent::coordinates::Point;
use crate::servo_model::motion::simulated_motion::{Fastest, ServoMotion};
use crate::servo_model::uncertainty::possible_servo::PossibleServo;
use crate::thresholds::{SERVO_TOP_SPEED_REACHED, UNDETERMINED_RATIO};
use offset::Formula;
use quantity_kind::QuantityKind;
use serde::{Deserialize, Serialize};
use servoid_dynamics::{Load, ServoParameters};
use std::f64::consts::TAU;

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

impl Quantity {
    /// Which quantity it is; `None` of one that this version does not know.
    #[must_use]
    pub fn kind(&self) -> Option<QuantityKind> {
        QuantityKind::named(&self.name)
    }
}

/// Allows for output that was recorded up to `seconds` earlier or later than it is taken for: the delay alone is a time from the edge of a
/// command.
pub(super) fn widen_delay(quantities: &mut [Quantity], seconds: f64) {
    let is_delay = |found: &&mut Quantity| found.kind() == Some(QuantityKind::Delay);
    for quantity in quantities.iter_mut().filter(is_delay) {
        let interval = quantity.interval;
        quantity.interval = interval.map(|found| found.widened(seconds));
    }
}

/// Ratio of the upper bound to the lower from which on the two exclude nothing.
const SENSELESS: f64 = 1e6;

/// Values that a quantity can have.
#[derive(Clone, Copy, PartialEq)]
enum Domain {
    /// All.
    Any,
    /// Zero and more; the interval is cut there.
    NotNegative,
    /// One and more; the interval is cut there.
    OneAndMore,
    /// More than zero, over decades; the interval is that of the logarithm.
    Positive,
}

/// How a quantity follows from a servo.
struct Definition {
    kind: QuantityKind,
    unit: Unit,
    /// Which values are possible.
    domain: Domain,
    /// The formula.
    of: Formula,
    /// How much of it the servo did in the record, if what it did not do is an extrapolation.
    reached: Option<fn(&Fastest) -> f64>,
}

const fn define(kind: QuantityKind, unit: Unit, domain: Domain, of: Formula) -> Definition {
    Definition {
        kind,
        unit,
        domain,
        of,
        reached: None,
    }
}

/// All quantities, in the order in which they are shown.
const DEFINITIONS: &[Definition] = &[
    define(
        QuantityKind::Delay,
        Unit::Seconds,
        Domain::NotNegative,
        |p, _| Some(p.delay_s),
    ),
    define(
        QuantityKind::Gain,
        Unit::OutputPerCommand,
        Domain::Any,
        |p, _| Some(p.gain),
    ),
    define(
        QuantityKind::Offset,
        Unit::Output,
        Domain::Any,
        offset::at_rest,
    ),
    define(
        QuantityKind::Bandwidth,
        Unit::Hertz,
        Domain::Positive,
        |p, _| Some(bandwidth_hz(p)),
    ),
    define(
        QuantityKind::DampingRatio,
        Unit::One,
        Domain::Positive,
        |p, _| Some(p.damping / (2.0 * p.stiffness.sqrt())),
    ),
    Definition {
        reached: Some(|fastest| fastest.upwards),
        ..define(
            QuantityKind::TopSpeedUpwards,
            Unit::OutputPerSecond,
            Domain::Positive,
            |p, middle| top_speeds(p, middle).map(|[up, _]| up),
        )
    },
    Definition {
        reached: Some(|fastest| fastest.downwards),
        ..define(
            QuantityKind::TopSpeedDownwards,
            Unit::OutputPerSecond,
            Domain::Positive,
            |p, middle| top_speeds(p, middle).map(|[_, down]| down),
        )
    },
    define(
        QuantityKind::AccelerationUpwards,
        Unit::OutputPerSecondSquared,
        Domain::Positive,
        |p, middle| accelerations(p, middle).map(|[up, _]| up),
    ),
    define(
        QuantityKind::AccelerationDownwards,
        Unit::OutputPerSecondSquared,
        Domain::Positive,
        |p, middle| accelerations(p, middle).map(|[_, down]| down),
    ),
    define(
        QuantityKind::ErrorOfFullDrive,
        Unit::Command,
        Domain::Positive,
        |p, _| p.limit.map(|l| l.up / p.stiffness),
    ),
    define(
        QuantityKind::DeadBand,
        Unit::Command,
        Domain::NotNegative,
        |p, _| p.dead_band,
    ),
    define(
        QuantityKind::RestingError,
        Unit::Command,
        Domain::NotNegative,
        |p, _| p.resting_error(),
    ),
    define(
        QuantityKind::FrictionAtRest,
        Unit::One,
        Domain::OneAndMore,
        |p, _| Some(1.0 + p.friction?.at_rest?.excess),
    ),
    define(
        QuantityKind::FrictionOfGears,
        Unit::One,
        Domain::NotNegative,
        |p, _| p.friction.map(|friction| friction.of_gears),
    ),
    define(
        QuantityKind::LoadAtMiddle,
        Unit::Command,
        Domain::Any,
        |p, middle| {
            let loaded = p.load != Load::None;
            loaded.then(|| p.load.at(middle) / p.stiffness)
        },
    ),
    define(
        QuantityKind::LoadOfLevelArm,
        Unit::Command,
        Domain::Any,
        |p, _| match p.load {
            Load::Pendulum { gravity, .. } => Some(gravity / p.stiffness),
            _ => None,
        },
    ),
];

/// Frequency at which the response to small commands has fallen by 3 dB \[Hz\], without load and friction.
fn bandwidth_hz(p: &ServoParameters<f64>) -> f64 {
    // |k/(k - ω² + jcω)|² = 1/2, a quadratic in ω².
    let half = p.stiffness - 0.5 * p.damping * p.damping;
    ((half + (half * half + p.stiffness * p.stiffness).sqrt()).sqrt()) / TAU
}

/// Speeds upwards and downwards under the load at the middle. With it, and not without: a constant load and unequal drives make the same
/// motion, and a record that does not distinguish them still determines these.
fn top_speeds(p: &ServoParameters<f64>, middle: f64) -> Option<[f64; 2]> {
    let speeds = p.top_speeds(p.load.at(middle))?;
    Some(p.upwards_first(speeds.map(|speed| speed * p.gain.abs())))
}

/// Accelerations of full drive upwards and downwards under the load at the middle, as [`top_speeds`], without friction; 0 where the load holds
/// the drive.
fn accelerations(p: &ServoParameters<f64>, middle: f64) -> Option<[f64; 2]> {
    let limit = p.drive_limit()?;
    let load = p.load.at(middle);
    let [up, down] = limit.both_ways();
    let net = [up - load, down + load];
    Some(p.upwards_first(net.map(|net| net.max(0.0) * p.gain.abs())))
}

/// The quantities of the first of `possible`, with intervals that hold those of all, where bounds hold; elsewhere with those of `others`.
pub(super) fn quantities(
    possible: &[PossibleServo],
    critical: f64,
    level: &Bounds<f64>,
    motion: &ServoMotion,
    others: &[Point],
) -> Vec<Quantity> {
    let middle = motion.commands.middle();
    let commands = 2.0 * motion.commands.amplitude();
    let gain = possible[0].point.physics(0, |_, value| value).gain;
    let largest_of = |unit: Unit| match unit {
        Unit::Command => commands,
        Unit::Output => commands * gain.abs(),
        // What the gears hold of themselves leaves nothing to turn them.
        Unit::One => 1.0,
        _ => f64::INFINITY,
    };
    let of = |definition: &Definition| {
        let value = definition.value(&possible[0].point, middle)?;
        let hull = possible
            .iter()
            .filter_map(|servo| definition.interval(servo, middle, critical))
            .reduce(hull)?;
        let hull = definition.without_senseless_bounds(hull);
        let interval = definition.as_far_as_reached(hull, level.valid().is_some(), &motion.fastest);
        Some(Quantity {
            name: definition.kind.name().to_owned(),
            unit: definition.unit,
            determined: definition.is_determined(&interval, largest_of(definition.unit))
                && !(level.valid().is_none() && definition.is_at_end(value)),
            value,
            interval: level.as_ref().map(|_| interval),
            other_fits: level
                .withdrawn()
                .map(|_| definition.spread(value, middle, others)),
        })
    };
    DEFINITIONS.iter().filter_map(of).collect()
}

/// The quantity `kind` of `servo`, `middle` being that of the commands; `None` of a servo that has none.
pub(super) fn value(kind: QuantityKind, servo: &ServoParameters, middle: f64) -> Option<f64> {
    let definition = DEFINITIONS.iter().find(|found| found.kind == kind)?;
    (definition.of)(servo, middle)
}

/// The smallest interval that holds both; the value is that of the first.
fn hull(a: Interval, b: Interval) -> Interval {
    let both = |x: Option<f64>, y: Option<f64>, of: fn(f64, f64) -> f64| Some(of(x?, y?));
    Interval {
        value: a.value,
        lower: both(a.lower, b.lower, f64::min),
        upper: both(a.upper, b.upper, f64::max),
    }
}

/// How far a coordinate that the record does not show may be off \[units of the command, or powers of e\]: further than any is.
const FARTHEST_OFF: f64 = 100.0;

impl Definition {
    /// Whether `value` is a delay of 0, the end of what the fit may choose: no servo has it, and without bounds it stands for what the model lacks.
    fn is_at_end(&self, value: f64) -> bool {
        self.kind == QuantityKind::Delay && value <= 0.0
    }

    fn value(&self, point: &Point, middle: f64) -> Option<f64> {
        (self.of)(&point.physics(0, |_, value| value), middle)
    }

    /// From `value` to those of `others`; one without the term counts as in [`Self::interval`].
    fn spread(&self, value: f64, middle: f64, others: &[Point]) -> Spread {
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
    fn interval(&self, servo: &PossibleServo, middle: f64, critical: f64) -> Option<Interval> {
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
    fn as_far_as_reached(&self, interval: Interval, holds: bool, fastest: &Fastest) -> Interval {
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
    fn without_senseless_bounds(&self, interval: Interval) -> Interval {
        let bounds = interval.lower.zip(interval.upper);
        let is_wide = bounds.is_some_and(|(lower, upper)| upper > SENSELESS * lower);
        match self.domain == Domain::Positive && is_wide {
            true => Interval {
                value: interval.value,
                ..Interval::default()
            },
            false => interval,
        }
    }

    /// Whether an interval says something: what is a ratio is known to a factor of ten, and what has a size to better than the `largest` that
    /// would show in the record, such as the travel.
    fn is_determined(&self, interval: &Interval, largest: f64) -> bool {
        let Some((lower, upper)) = interval.lower.zip(interval.upper) else {
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

/// The names of all quantities.
#[cfg(test)]
pub(super) fn names() -> impl Iterator<Item = &'static str> {
    DEFINITIONS.iter().map(|definition| definition.kind.name())
}

/// The quantities of a servo under commands about zero by name, without intervals.
#[cfg(test)]
pub(super) fn values(point: &Point) -> Vec<(&'static str, f64)> {
    let of = |definition: &Definition| {
        let value = definition.value(point, 0.0)?;
        Some((definition.kind.name(), value))
    };
    DEFINITIONS.iter().filter_map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::results::Reason;

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
