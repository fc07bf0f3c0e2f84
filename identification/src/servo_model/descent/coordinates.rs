//! The numbers that the fit moves, and the servo that they stand for.
//!
//! Quantities that are positive and range over decades are logarithms. Load and friction are divided by the
//! stiffness, so they are errors at rest in units of the command, which a record shows directly.

use crate::servo_model::stretches::Stretch;
use serde::{Deserialize, Serialize};
use servoid_dynamics::{
    AtRest, DriveLimit, Friction, Load, PulseEnd, Scalar, ServoParameters, SpeedLimit, Stops,
};

/// One number that the fit moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Coordinate {
    /// d \[s\].
    Delay,
    /// ln k (k in 1/s²); of a servo under a spring ln(k + κ), the stiffness of both together, which small motion shows. What is said to be over k
    /// is over that then.
    LnStiffness,
    /// ln c (c in 1/s).
    LnDamping,
    /// Output for each unit of the command at rest: under a spring k/(k + κ) times that for each unit of θ.
    Gain,
    /// Output at command 0.
    Offset,
    /// ln(A+/B), the top speed upwards without friction (units of the command for each second).
    LnTopSpeed,
    /// B/c, the motor's own share of the damping.
    MotorShare,
    /// ln(A-/A+), or ln(V-/V+) where the speed is limited.
    LnDownToUp,
    /// ln V+ (units of the command for each second).
    LnSpeedLimit,
    /// ln A+ where the speed is limited (units of the command for each second, squared).
    LnAcceleration,
    /// w \[units of the command\].
    DeadBand,
    /// b, the whole width \[units of the command\].
    Play,
    /// C/k \[units of the command\].
    Friction,
    /// s: friction at rest is 1 + s times that at speed.
    FrictionAtRest,
    /// μ, the friction of the gears as a share of drive and load.
    FrictionOfGears,
    /// Constant load over k \[units of the command\].
    ConstantLoad,
    /// κ/(k + κ), the share of a spring in the stiffness. Beside it stiffness and gain stay what small motion shows, so that the fit does not have to follow
    /// all three along a valley.
    Spring,
    /// Acceleration of a weight on a level arm, over k \[units of the command\].
    Gravity,
    /// Angle of that arm from the vertical at θ = 0 \[units of the command\].
    GravityFrom,
    /// Stiffening of the load of the air, over k \[1/unit of the command\].
    AirStiffening,
    /// θ from which the load of the air stiffens \[units of the command\].
    AirFrom,
    /// ln(k_j/k) of the second and further controllers on the same mechanism.
    LnOwnStiffness(usize),
}

use Coordinate::{
    AirFrom, AirStiffening, ConstantLoad, DeadBand, Delay, FrictionAtRest, FrictionOfGears, Gain,
    Gravity, GravityFrom, LnAcceleration, LnDamping, LnDownToUp, LnOwnStiffness, LnSpeedLimit,
    LnStiffness, LnTopSpeed, MotorShare, Offset, Play, Spring,
};

/// ωs B/A+, the speed at which half of the excess of friction at rest is gone, as a share of the top speed. Records hardly show
/// it: left free it ran to the least that the integration resolves, where other recordings of the same servo were
/// predicted to 70 %; with 0.045 to 0.06 to 84 to 95 %.
pub(crate) const FRICTION_SPEED_SHARE: f64 = 0.05;

impl Coordinate {
    pub(crate) fn is_of_friction(self) -> bool {
        matches!(self, Self::Friction | FrictionAtRest | FrictionOfGears)
    }

    /// Whether a step of the fit may move it by one at the most: a factor of e.
    pub(super) fn is_logarithm(self) -> bool {
        matches!(
            self,
            LnStiffness
                | LnDamping
                | LnTopSpeed
                | LnDownToUp
                | LnSpeedLimit
                | LnAcceleration
                | LnOwnStiffness(_)
        )
    }

    /// `value` after the step `change` of the fit. The share of a motor that is hardly damped and its top speed have a product that a record
    /// determines, and no limits: both go there in logarithms, in which that is a straight line.
    pub(super) fn moved(self, value: f64, change: f64) -> f64 {
        match self {
            MotorShare => value * (change / value).clamp(-1.0, 1.0).exp(),
            _ if self.is_logarithm() => value + change.clamp(-1.0, 1.0),
            _ => value + change,
        }
    }

    /// The values that make a servo. Logarithms are held within what `f64` and the step of the integration can do.
    pub(crate) fn range(self, longest_delay_s: f64) -> (f64, f64) {
        match self {
            Delay => (0.0, longest_delay_s),
            LnStiffness => (-6.0, 18.0),
            LnDamping => (-5.0, 12.0),
            LnTopSpeed | LnSpeedLimit => (-12.0, 25.0),
            LnAcceleration => (-12.0, 30.0),
            MotorShare => (1e-5, 1.0),
            FrictionOfGears => (0.0, 0.9),
            Spring => (-4.0, 0.9),
            LnDownToUp | LnOwnStiffness(_) => (-4.0, 4.0),
            DeadBand | Play | Coordinate::Friction | FrictionAtRest => (0.0, f64::INFINITY),
            Gain | Offset | ConstantLoad | Gravity | GravityFrom | AirStiffening | AirFrom => {
                (f64::NEG_INFINITY, f64::INFINITY)
            }
        }
    }
}

/// Which terms of the equation a servo has.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Terms {
    /// The drive is limited.
    pub limit: bool,
    /// The drive is stronger in one direction; where the speed is limited, that is what is larger in one direction.
    pub two_speeds: bool,
    /// Only the limit of the drive is larger in one direction, and the loop is as stiff in both.
    #[serde(default, skip_serializing_if = "is_false")]
    pub one_stiffness: bool,
    /// The speed is cut off at a limit. The motor has no damping of its own then.
    #[serde(default, skip_serializing_if = "is_false")]
    pub speed_limit: bool,
    /// The controller has a dead band.
    pub dead_band: bool,
    /// The output has play.
    #[serde(default, skip_serializing_if = "is_false")]
    pub play: bool,
    /// There is friction.
    pub friction: bool,
    /// It grows with the torque through the gears. Only with friction.
    pub friction_of_gears: bool,
    /// The kind of load.
    pub load: LoadKind,
}

/// A term that documents name only where the servo has it.
fn is_false(term: &bool) -> bool {
    !term
}

/// The load on the shaft.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LoadKind {
    /// None.
    #[default]
    None,
    /// A constant torque.
    Constant,
    /// A weight on an arm that hangs at θ = 0: G sin θ.
    Pendulum,
    /// A spring, or a surface in the air at small angles: a constant torque and one that grows with θ.
    Spring,
    /// A weight on an arm that hangs at another angle: G sin(θ + θ0).
    TiltedPendulum,
    /// A surface in the air, whose load stiffens beyond an angle.
    Air,
}

impl LoadKind {
    /// All kinds, those with fewer coordinates first.
    pub(crate) const BY_COORDINATES: [Self; 6] = [
        Self::None,
        Self::Constant,
        Self::Pendulum,
        Self::Spring,
        Self::TiltedPendulum,
        Self::Air,
    ];

    /// The kinds before this one.
    pub(crate) fn simpler(self) -> &'static [Self] {
        let own = Self::BY_COORDINATES.iter().position(|kind| *kind == self);
        &Self::BY_COORDINATES[..own.unwrap_or(0)]
    }
}

impl Terms {
    /// Whether strokes have a top speed.
    #[must_use]
    pub fn is_limited(self) -> bool {
        self.limit || self.speed_limit
    }

    /// The coordinates of a servo with these terms and `controllers` controllers.
    pub(crate) fn coordinates(self, controllers: usize) -> Vec<Coordinate> {
        let mut all = vec![Delay, LnStiffness, LnDamping, Gain, Offset];
        let mut with = |wanted: bool, coordinates: &[Coordinate]| {
            if wanted {
                all.extend_from_slice(coordinates);
            }
        };
        with(self.speed_limit, &[LnSpeedLimit]);
        with(self.limit && self.speed_limit, &[LnAcceleration]);
        with(self.limit && !self.speed_limit, &[LnTopSpeed, MotorShare]);
        with(self.two_speeds, &[LnDownToUp]);
        with(self.dead_band, &[DeadBand]);
        with(self.play, &[Play]);
        with(self.friction, &[Coordinate::Friction, FrictionAtRest]);
        with(self.friction_of_gears, &[FrictionOfGears]);
        match self.load {
            LoadKind::None => {}
            LoadKind::Constant => with(true, &[ConstantLoad]),
            LoadKind::Pendulum => with(true, &[Gravity]),
            LoadKind::Spring => with(true, &[ConstantLoad, Spring]),
            LoadKind::TiltedPendulum => with(true, &[Gravity, GravityFrom]),
            LoadKind::Air => with(true, &[ConstantLoad, AirStiffening, AirFrom]),
        }
        all.extend((1..controllers).map(LnOwnStiffness));
        all
    }
}

/// How far an arm on the shaft turns.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum ArmTurn {
    /// Radians for each unit of the command.
    OfCommand(f64),
    /// Radians for each unit of the output, which is an angle: the gain makes those of the command of it.
    OfOutput(f64),
}

impl ArmTurn {
    /// By the output, where that is an angle.
    pub(crate) fn of(per_command: f64, per_output: Option<f64>) -> Self {
        per_output.map_or(Self::OfCommand(per_command), Self::OfOutput)
    }

    /// Radians for each unit of the command, of a servo with this gain.
    pub(crate) fn radians<S: Scalar>(self, gain: S) -> S {
        match self {
            Self::OfCommand(radians) => S::constant(radians),
            Self::OfOutput(radians) => gain.abs() * radians,
        }
    }
}

/// A point of the search: terms, their coordinates, and the values of these.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Point {
    pub(crate) terms: Terms,
    pub(crate) coordinates: Vec<Coordinate>,
    pub(crate) values: Vec<f64>,
    /// How far an arm on the shaft turns.
    pub(crate) arm: ArmTurn,
    /// The speed at which half of the excess of friction at rest is gone, as a share of the top speed.
    pub(crate) friction_speed_share: f64,
    /// What the offset of each run is above the common one \[output\]; empty where all runs have the same.
    pub(crate) run_offsets: Vec<f64>,
    /// Stops that the record shows by itself, at the common offset.
    pub(crate) stops: Stops,
    /// Where the servo knows a pulse at its end, what its length adds to the delay.
    pub(crate) pulse_end: Option<PulseEnd>,
}

impl Point {
    /// The value of one coordinate.
    pub(crate) fn get(&self, coordinate: Coordinate) -> Option<f64> {
        let index = self.coordinates.iter().position(|at| *at == coordinate)?;
        Some(self.values[index])
    }

    /// Sets one coordinate, if the point has it.
    pub(crate) fn set(&mut self, coordinate: Coordinate, value: f64) {
        if let Some(index) = self.coordinates.iter().position(|at| *at == coordinate) {
            self.values[index] = value;
        }
    }

    /// The same servo with other terms: shared coordinates keep their values, new ones get that of `fresh`.
    pub(crate) fn with_terms(
        &self,
        terms: Terms,
        controllers: usize,
        fresh: impl Fn(Coordinate) -> f64,
    ) -> Self {
        let coordinates = terms.coordinates(controllers);
        let value = |at: &Coordinate| self.get(*at).unwrap_or_else(|| fresh(*at));
        Self {
            terms,
            values: coordinates.iter().map(value).collect(),
            coordinates,
            arm: self.arm,
            friction_speed_share: self.friction_speed_share,
            run_offsets: self.run_offsets.clone(),
            stops: self.stops,
            pulse_end: self.pulse_end,
        }
    }

    /// The servo that moved in `stretch`: with the controller and the offset of its run.
    pub(crate) fn servo_of<S: Scalar>(
        &self,
        stretch: &Stretch,
        number: impl Fn(usize, f64) -> S,
    ) -> ServoParameters<S> {
        let servo = self.physics(stretch.controller, number);
        match self.run_offsets.get(stretch.run) {
            Some(own) => servo.seen_from(*own),
            None => servo,
        }
    }

    /// The servo with the controller number `controller`, where `number` makes a number of a coordinate's index and
    /// value: the value itself, or a variable.
    pub(crate) fn physics<S: Scalar>(
        &self,
        controller: usize,
        number: impl Fn(usize, f64) -> S,
    ) -> ServoParameters<S> {
        let find = |wanted: Coordinate| {
            let index = self.coordinates.iter().position(|at| *at == wanted)?;
            Some(number(index, self.values[index]))
        };
        let get = |wanted| find(wanted).unwrap_or(S::constant(0.0));
        let shared = get(LnStiffness).exp();
        let of_loop = S::constant(1.0) - get(Spring);
        let stiffness = match find(LnOwnStiffness(controller)) {
            Some(own) => shared * of_loop * own.exp(),
            None => shared * of_loop,
        };
        let damping = get(LnDamping).exp();
        let of_motor = find(LnTopSpeed).map(|top_speed| {
            let motor_damping = damping * get(MotorShare);
            DriveLimit {
                up: top_speed.exp() * motor_damping,
                down_to_up: get(LnDownToUp).exp(),
                motor_damping,
                at_one_stiffness: self.terms.one_stiffness,
            }
        });
        let alike = |acceleration: S| DriveLimit {
            up: acceleration.exp(),
            down_to_up: S::constant(1.0),
            motor_damping: S::constant(0.0),
            at_one_stiffness: false,
        };
        let speed_limit = find(LnSpeedLimit).map(|speed| SpeedLimit {
            up: speed.exp(),
            down_to_up: get(LnDownToUp).exp(),
        });
        let at_rest = find(FrictionAtRest).map(|excess| AtRest {
            excess,
            speed: (find(LnSpeedLimit).unwrap_or(get(LnTopSpeed))).exp()
                * self.friction_speed_share,
        });
        let constant = get(ConstantLoad) * shared;
        ServoParameters {
            delay_s: get(Delay),
            pulse_end: self.pulse_end,
            stiffness,
            damping,
            gain: get(Gain) / of_loop,
            offset: get(Offset),
            limit: of_motor.or_else(|| find(LnAcceleration).map(alike)),
            speed_limit,
            dead_band: find(DeadBand),
            play: find(Play),
            friction: find(Coordinate::Friction).map(|width| Friction {
                coulomb: width * shared,
                of_gears: get(FrictionOfGears),
                at_rest,
            }),
            load: match self.terms.load {
                LoadKind::None => Load::None,
                LoadKind::Constant => Load::Constant(constant),
                LoadKind::Pendulum | LoadKind::TiltedPendulum => Load::Pendulum {
                    gravity: get(Gravity) * shared,
                    from: get(GravityFrom),
                    radians: self.arm.radians(get(Gain) / of_loop),
                },
                LoadKind::Spring => Load::Spring {
                    constant,
                    rate: get(Spring) * shared,
                },
                LoadKind::Air => Load::Air {
                    constant,
                    stiffening: get(AirStiffening) * shared,
                    from: get(AirFrom),
                },
            },
            stops: self.stops,
        }
    }
}
