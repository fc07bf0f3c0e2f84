//! How each quantity follows from a servo.

use super::offset::{self, Formula};
use super::quantity::Unit;
use super::quantity_kind::QuantityKind;
use crate::servo_model::descent::coordinates::Point;
use crate::servo_model::motion::simulated_motion::Fastest;
use servoid_dynamics::{Load, ServoParameters};
use std::f64::consts::TAU;

/// Values that a quantity can have.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Domain {
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
pub(super) struct Definition {
    pub(super) kind: QuantityKind,
    pub(super) unit: Unit,
    /// Which values are possible.
    pub(super) domain: Domain,
    /// The formula.
    pub(super) of: Formula,
    /// How much of it the servo did in the record, if what it did not do is an extrapolation.
    pub(super) reached: Option<fn(&Fastest) -> f64>,
}

pub(super) const fn define(
    kind: QuantityKind,
    unit: Unit,
    domain: Domain,
    of: Formula,
) -> Definition {
    Definition {
        kind,
        unit,
        domain,
        of,
        reached: None,
    }
}

/// All quantities, in the order in which they are shown.
pub(super) const DEFINITIONS: &[Definition] = &[
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
        |p, middle| Some(p.gain * p.stiffness / stiffness_under_load(p, middle)?),
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
        bandwidth_hz,
    ),
    define(
        QuantityKind::DampingRatio,
        Unit::One,
        Domain::Positive,
        |p, middle| {
            let stiffness = stiffness_under_load(p, middle)?;
            Some(p.damping / (2.0 * stiffness.sqrt()))
        },
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
        QuantityKind::Play,
        Unit::Output,
        Domain::NotNegative,
        |p, _| p.play.map(|width| width * p.gain.abs()),
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
        QuantityKind::SpringOfLoad,
        Unit::One,
        Domain::Any,
        |p, _| match p.load {
            Load::Spring { rate, .. } => Some(rate / p.stiffness),
            _ => None,
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

/// The stiffness of loop and load together at the angle `middle` (1/s²); `None` where the load turns the shaft away.
fn stiffness_under_load(p: &ServoParameters<f64>, middle: f64) -> Option<f64> {
    Some(p.stiffness + p.load.rate_at(middle)).filter(|stiffness| *stiffness > 0.0)
}

/// Frequency at which the response to small commands has fallen by 3 dB \[Hz\], under the load about the middle and without friction.
fn bandwidth_hz(p: &ServoParameters<f64>, middle: f64) -> Option<f64> {
    let stiffness = stiffness_under_load(p, middle)?;
    // |K/(K - ω² + jcω)|² = 1/2, a quadratic in ω².
    let half = stiffness - 0.5 * p.damping * p.damping;
    Some(((half + (half * half + stiffness * stiffness).sqrt()).sqrt()) / TAU)
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

impl Definition {
    pub(super) fn value(&self, point: &Point, middle: f64) -> Option<f64> {
        (self.of)(&point.physics(0, |_, value| value), middle)
    }
}
