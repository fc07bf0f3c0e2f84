//! Servos drawn at random, within the model's class and a little outside of it.

use super::truth::{Beyond, Truth};
use crate::servo_model::descent::coordinates::{
    ArmTurn, Coordinate, FRICTION_SPEED_SHARE, LoadKind, Point, Terms,
};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use servoid_dynamics::Stops;
use std::fmt;

/// From the lowest command of the references to the highest \[deg\].
pub(super) const STROKE: f64 = 10.0;

/// What kind of servo is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    InClass,
    /// Within the class too, at the edge of it: the drive is there at once, so that only the speed is limited.
    RateLimit,
    /// Within the class too, at its other edge: only the acceleration is limited.
    UndampedMotor,
    /// Within the class too: the speed is cut off at a limit, and the acceleration has one or not.
    CutOffSpeed,
    /// Within the class too: under the load of a spring.
    Spring,
    /// Within the class too: with a dead band and with friction, which rest alike.
    DeadBandAndFriction,
    /// As those, with limits of the drive that differ at one stiffness.
    UnequalLimits,
    /// Within the class too: the gears take a share of what turns them, beside Coulomb friction.
    FrictionOfGears,
    /// Within the class too: friction at rest is half gone at another speed than the fit begins with.
    FrictionAtLowSpeed,
    /// Within the class too: play between the shaft and the output.
    Play,
    Stiction,
    CurrentLimit,
    DriveLag,
    QuantisedDrive,
    UnequalSides,
}

impl Kind {
    pub(super) const ALL: [Self; 15] = [
        Self::InClass,
        Self::RateLimit,
        Self::UndampedMotor,
        Self::CutOffSpeed,
        Self::Spring,
        Self::DeadBandAndFriction,
        Self::UnequalLimits,
        Self::FrictionOfGears,
        Self::FrictionAtLowSpeed,
        Self::Play,
        Self::Stiction,
        Self::CurrentLimit,
        Self::DriveLag,
        Self::QuantisedDrive,
        Self::UnequalSides,
    ];

    /// What servos of this kind have beyond the class.
    fn beyond(self, top_speed: f64, between: &mut impl FnMut(f64, f64) -> f64) -> Beyond {
        match self {
            Self::InClass
            | Self::RateLimit
            | Self::UndampedMotor
            | Self::CutOffSpeed
            | Self::Spring
            | Self::DeadBandAndFriction
            | Self::UnequalLimits
            | Self::FrictionOfGears
            | Self::FrictionAtLowSpeed
            | Self::Play => Beyond::Nothing,
            Self::Stiction => Beyond::Stiction {
                excess: between(0.5, 2.0),
                until: top_speed * between(0.002, 0.02),
            },
            Self::CurrentLimit => Beyond::CurrentLimit {
                share: between(0.4, 0.8),
            },
            Self::DriveLag => Beyond::DriveLag {
                lag_s: between(0.0003, 0.0015),
            },
            Self::QuantisedDrive => Beyond::QuantisedDrive { step: 0.01 },
            Self::UnequalSides => Beyond::UnequalSides {
                limit: between(-0.3, 0.3).exp(),
                motor: between(-0.3, 0.3).exp(),
            },
        }
    }
}

impl fmt::Display for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::InClass => "in class",
            Self::RateLimit => "rate limit",
            Self::UndampedMotor => "undamped motor",
            Self::CutOffSpeed => "cut-off speed",
            Self::Spring => "spring",
            Self::DeadBandAndFriction => "dead band and friction",
            Self::UnequalLimits => "unequal limits",
            Self::FrictionOfGears => "friction of the gears",
            Self::FrictionAtLowSpeed => "friction at low speed",
            Self::Play => "play",
            Self::Stiction => "stiction",
            Self::CurrentLimit => "current limit",
            Self::DriveLag => "drive lag",
            Self::QuantisedDrive => "quantised drive",
            Self::UnequalSides => "unequal sides",
        })
    }
}

/// Damping of a drive that is there at once (1/s): full speed after a quarter of a millisecond.
const AT_ONCE: f64 = 4000.0;

/// The servo number `seed` of a kind, within the ranges that docs/servo-model.md states.
pub(super) fn servo(kind: Kind, seed: u64) -> Truth {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut between = |low: f64, high: f64| random.random_range(low..high);
    let terms = terms(kind, seed);
    let [stiffness, damping, full_drive, share] = match kind {
        Kind::RateLimit => {
            // The lag behind the limit \[s\] may be shorter than a sample period.
            let lag_s = between(0.0005, 0.015);
            let full_drive = between(60.0, 250.0) * lag_s;
            [AT_ONCE / lag_s, AT_ONCE, full_drive, 0.9]
        }
        _ => {
            let bandwidth = between(25.0, 70.0);
            let damping = 2.0 * between(0.6, 1.1) * bandwidth;
            let full_drive = between(1.0, 4.0);
            let share = match kind {
                Kind::UndampedMotor => 1e-4,
                _ => between(0.2, 0.6),
            };
            [bandwidth * bandwidth, damping, full_drive, share]
        }
    };
    let top_speed = match kind {
        // A linear servo of this bandwidth would reach 3.7 times it in strokes of 10 degrees.
        Kind::CutOffSpeed => stiffness.sqrt() * between(0.8, 2.0),
        _ => full_drive * stiffness / (share * damping),
    };
    let friction_speed_share = match kind {
        Kind::FrictionAtLowSpeed => between(0.004f64.ln(), 0.04f64.ln()).exp(),
        _ => FRICTION_SPEED_SHARE,
    };
    let mut value = |at: &Coordinate| match at {
        Coordinate::Delay => Truth::on_grid(between(0.006, 0.04)),
        Coordinate::LnStiffness => stiffness.ln(),
        Coordinate::LnDamping => damping.ln(),
        Coordinate::Gain => between(0.8, 1.2),
        Coordinate::Offset => between(-1.0, 1.0),
        Coordinate::LnTopSpeed | Coordinate::LnSpeedLimit => top_speed.ln(),
        Coordinate::LnAcceleration => (top_speed / between(0.008, 0.04)).ln(),
        Coordinate::MotorShare => share,
        Coordinate::LnDownToUp => between(-0.4, 0.4),
        Coordinate::DeadBand => between(0.1, 0.4),
        Coordinate::Play => STROKE * between(0.005f64.ln(), 0.1f64.ln()).exp(),
        Coordinate::Friction => between(0.05, 0.3),
        Coordinate::FrictionAtRest => between(0.0, 1.0),
        Coordinate::FrictionOfGears => between(0.05, 0.35),
        Coordinate::ConstantLoad => between(-0.5, 0.5),
        Coordinate::Spring => between(0.02, 0.15),
        _ => 0.0,
    };
    let coordinates = terms.coordinates(1);
    let point = Point {
        terms,
        values: coordinates.iter().map(&mut value).collect(),
        coordinates,
        arm: ArmTurn::OfCommand(1f64.to_radians()),
        friction_speed_share,
        run_offsets: Vec::new(),
        stops: Stops::default(),
        pulse_end: None,
    };
    let beyond = kind.beyond(top_speed, &mut between);
    Truth { point, beyond }
}

/// Half of the servos have two speeds, a third each dead band and friction, and a third a constant load; all of one kind that of a spring. Two kinds have both, a dead band and
/// friction. Three kinds have friction by what they are, and that of the gears is drawn in its own kind alone.
fn terms(kind: Kind, seed: u64) -> Terms {
    let loads = [LoadKind::None, LoadKind::Constant, LoadKind::None];
    let has_both = matches!(kind, Kind::DeadBandAndFriction | Kind::UnequalLimits);
    Terms {
        limit: kind != Kind::CutOffSpeed || seed / 2 % 2 == 1,
        two_speeds: seed % 2 == 1 || kind == Kind::UnequalLimits,
        one_stiffness: kind == Kind::UnequalLimits,
        speed_limit: kind == Kind::CutOffSpeed,
        dead_band: seed % 3 == 1 || has_both,
        play: kind == Kind::Play,
        friction: seed % 3 == 2
            || matches!(
                kind,
                Kind::Stiction | Kind::FrictionOfGears | Kind::FrictionAtLowSpeed
            )
            || has_both,
        friction_of_gears: kind == Kind::FrictionOfGears,
        load: match kind {
            Kind::Spring => LoadKind::Spring,
            Kind::UnequalLimits => LoadKind::None,
            _ => loads[seed as usize / 3 % 3],
        },
    }
}
