//! The equation of the servo as a machine.
//!
//! A motor behind a position controller, with r the command, u the input of the record, d the delay and y the
//! measured output. θ (in units of the command) is the angle of the shaft and ω its speed:
//!
//! ```text
//! r(t)  = u(t - d)                                       where the servo knows a pulse at its end, d grows with that pulse
//! e     = r - θ beyond a dead band of ±w, and counts from its edge
//! drive = k e - (c - B) ω, between -A- and A+            acceleration; k and c - B are A-/A+ times as large where it is negative
//! ω'    = drive - B ω - friction - load(θ)            0 where ω is at its limit, V+ or -V-, and this would take it beyond
//! θ'    = ω,     y = gain φ + offset                     φ = θ; behind play of the width b it stays where it is while |θ - φ| < b/2
//! ```
//!
//! At small signals this is a second-order system with the stiffness k (1/s²) and the damping c (1/s), of which the
//! motor's own part is B. Where the error exceeds E = A+/k the drive is full. The top speed towards
//! larger θ is then (A+ - friction - load)/B. The output falls there if the gain is negative; upwards is where the output grows.
//!
//! A motor comes to its top speed by and by. The speed of a servo that follows a profile, of its own or of a simulation, is cut
//! off at V instead. Such a servo has no B, and one drive for both directions: its speeds may differ.
//!
//! Friction is Coulomb's, C, and a share μ of the torque through the gears, drive + load, which presses their teeth together;
//! both are larger at rest: (C + μ |drive + load|) (1 + s/(1 + (ω/ωs)²)) (D. P. Hess and A. Soom, "Friction at a
//! lubricated line contact operating at oscillating sliding velocities", Journal of Tribology, 1990). It holds the
//! shaft at rest while less than that acts on it, so the resting error depends on the direction of approach, without load and
//! gears by (1 + s) C/k to each side. A stop takes all speed, and holds the shaft until that is driven back.

use crate::dual::Scalar;

/// Numbers that a servo has at the most.
pub const PARAMETERS: usize = 17;

/// Derivatives by the parameters, in the order of [`ServoParameters::in_order`].
pub type Slopes = [f64; PARAMETERS];

/// Load on the shaft \[acceleration\]; positive turns towards smaller angles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Load<S> {
    /// None.
    None,
    /// The same everywhere, such as the pull of a spring that hardly gives.
    Constant(S),
    /// A weight on an arm: `gravity` sin(θ + `from`).
    Pendulum {
        /// Acceleration with the arm level.
        gravity: S,
        /// θ + `from` is the angle from the vertical \[units of the command\].
        from: S,
        /// Radians for each unit of the command.
        radians: S,
    },
    /// A spring, or the hinge moment of a surface in the air at small angles: `constant` + `rate` θ.
    Spring {
        /// Acceleration at θ = 0.
        constant: S,
        /// Its growth (1/s²); positive turns back.
        rate: S,
    },
    /// The hinge moment of a surface in the air: `constant` + `stiffening` (θ - `from`)² beyond `from`. Where
    /// `stiffening` is negative, beyond means below.
    Air {
        /// Acceleration before it stiffens.
        constant: S,
        /// Its growth \[acceleration for each unit of the command, squared\].
        stiffening: S,
        /// θ where it begins to stiffen.
        from: S,
    },
}

impl<S: Scalar> Load<S> {
    /// Its numbers, 0 where it has fewer.
    fn in_order(&self) -> [S; 3] {
        let none = S::constant(0.0);
        match *self {
            Self::None => [none; 3],
            Self::Constant(constant) => [constant, none, none],
            Self::Pendulum {
                gravity,
                from,
                radians,
            } => [gravity, from, radians],
            Self::Spring { constant, rate } => [constant, rate, none],
            Self::Air {
                constant,
                stiffening,
                from,
            } => [constant, stiffening, from],
        }
    }

    /// The acceleration that it takes at the angle `angle`.
    #[inline(always)]
    #[must_use]
    pub fn at(&self, angle: S) -> S {
        match *self {
            Self::None => S::constant(0.0),
            Self::Constant(constant) => constant,
            Self::Pendulum {
                gravity,
                from,
                radians,
            } => gravity * ((angle + from) * radians).sin(),
            Self::Spring { constant, rate } => constant + rate * angle,
            Self::Air {
                constant,
                stiffening,
                from,
            } => {
                let beyond = angle - from;
                if beyond.value() * stiffening.value() > 0.0 {
                    constant + stiffening * beyond * beyond
                } else {
                    constant
                }
            }
        }
    }
}

impl Load<f64> {
    /// Whether it is another one at another angle.
    #[must_use]
    pub fn changes_with_angle(&self) -> bool {
        !matches!(self, Self::None | Self::Constant(_))
    }

    /// Its growth with the angle at `angle` (1/s²).
    #[must_use]
    pub fn rate_at(&self, angle: f64) -> f64 {
        self.slopes_at(angle).0
    }

    /// Its derivatives at `angle`: by the angle, and by its own numbers.
    #[inline(always)]
    pub(crate) fn slopes_at(&self, angle: f64) -> (f64, [f64; 3]) {
        match *self {
            Self::None => (0.0, [0.0; 3]),
            Self::Constant(_) => (0.0, [1.0, 0.0, 0.0]),
            Self::Pendulum {
                gravity,
                from,
                radians,
            } => {
                let (sin, cos) = ((angle + from) * radians).sin_cos();
                let by_angle = gravity * radians * cos;
                let by_radians = gravity * (angle + from) * cos;
                (by_angle, [sin, by_angle, by_radians])
            }
            Self::Spring { rate, .. } => (rate, [1.0, angle, 0.0]),
            Self::Air {
                stiffening, from, ..
            } => {
                let beyond = angle - from;
                if beyond * stiffening > 0.0 {
                    let by_angle = 2.0 * stiffening * beyond;
                    (by_angle, [1.0, beyond * beyond, -by_angle])
                } else {
                    (0.0, [1.0, 0.0, 0.0])
                }
            }
        }
    }
}

/// Friction that opposes the motion \[acceleration\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Friction<S> {
    /// C, at speed.
    pub coulomb: S,
    /// μ, the share of drive and load that the gears take.
    pub of_gears: S,
    /// What it has more at rest.
    pub at_rest: Option<AtRest<S>>,
}

impl<S: Scalar> Friction<S> {
    /// Friction at speed where drive and load together are `through_gears` \[acceleration\].
    #[inline(always)]
    #[must_use]
    pub fn in_motion(&self, through_gears: S) -> S {
        self.coulomb + through_gears.abs() * self.of_gears
    }
}

/// Friction that falls with speed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AtRest<S> {
    /// s: at rest the friction is 1 + s times that at speed.
    pub excess: S,
    /// ωs, the speed at which half of the excess is gone.
    pub speed: S,
}

impl<S: Scalar> AtRest<S> {
    /// Friction at `speed`, relative to that at large ones.
    #[inline(always)]
    pub(crate) fn factor(&self, speed: S) -> S {
        let relative = speed / self.speed;
        let one = S::constant(1.0);
        one + self.excess / (one + relative * relative)
    }
}

/// The largest drive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DriveLimit<S> {
    /// A+, the largest acceleration towards larger θ.
    pub up: S,
    /// A-/A+.
    pub down_to_up: S,
    /// B, the motor's own damping (1/s): what slows it while the drive is full.
    pub motor_damping: S,
    /// Whether the directions differ in their limit alone. Else all of the drive is as much stronger in one, its stiffness and the damping of the
    /// loop, too.
    pub at_one_stiffness: bool,
}

/// The largest speed, which is cut off there: a motor comes to its own [by and by](DriveLimit::motor_damping). With it the drive is alike in
/// both directions, and the motor has no damping of its own: what a [`DriveLimit`] has of these does not count.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpeedLimit<S> {
    /// V+, the largest speed towards larger θ \[units of the command/s\].
    pub up: S,
    /// V-/V+.
    pub down_to_up: S,
}

impl<S: Scalar> DriveLimit<S> {
    /// A+ and A-, the largest accelerations towards larger and smaller θ.
    #[inline(always)]
    #[must_use]
    pub fn both_ways(&self) -> [S; 2] {
        [self.up, self.up * self.down_to_up]
    }

    /// What the loop has towards smaller θ over what it has towards larger ones: A-/A+, or 1 at one stiffness.
    #[inline(always)]
    #[must_use]
    pub fn loop_down_to_up(&self) -> S {
        match self.at_one_stiffness {
            true => S::constant(1.0),
            false => self.down_to_up,
        }
    }
}

impl<S: Scalar> SpeedLimit<S> {
    /// V+ and V-, the largest speeds towards larger and smaller θ.
    #[inline(always)]
    #[must_use]
    pub fn both_ways(&self) -> [S; 2] {
        [self.up, self.up * self.down_to_up]
    }
}

/// The outputs at which the shaft meets a stop: it takes all speed, and holds the shaft until that is driven back.
///
/// A stop is an angle of the mechanism. It is known by the output that the sensor shows there, which a record shows by itself: that stays where it is
/// when offset and gain are estimated, and the angle is [what follows](ServoParameters::range). Where the zero of the sensor moves, the angle
/// stays, and the output there [moves with the zero](Self::seen_from).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Stops {
    /// The least output, where there is a stop \[output\].
    pub lower: Option<f64>,
    /// The largest output, where there is a stop \[output\].
    pub upper: Option<f64>,
}

impl Stops {
    /// The same angles seen by a sensor whose zero is `higher` \[output\].
    #[must_use]
    pub fn seen_from(self, higher: f64) -> Self {
        Self {
            lower: self.lower.map(|end| end + higher),
            upper: self.upper.map(|end| end + higher),
        }
    }

    /// How many there are.
    #[must_use]
    pub fn count(&self) -> usize {
        [self.lower, self.upper].into_iter().flatten().count()
    }

    /// Whether there is none.
    #[must_use]
    pub fn are_none(&self) -> bool {
        *self == Self::default()
    }

    /// Whether the shaft can move between them.
    #[must_use]
    pub fn have_travel(&self) -> bool {
        let both = self.lower.zip(self.upper);
        both.is_none_or(|(lower, upper)| lower < upper)
    }
}

/// A servo that takes pulses knows each at its end: a longer one acts later by what it is longer. The delay is that of the neutral command.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PulseEnd {
    /// What the pulse is longer by for each unit of the command \[s\]; negative where a longer pulse is a smaller command.
    pub s_per_command: f64,
    /// The command whose pulse ends with the delay \[units of the command\].
    pub neutral: f64,
}

impl PulseEnd {
    /// How much later than the neutral command `command` acts \[s\].
    #[must_use]
    pub fn later_s(self, command: f64) -> f64 {
        self.s_per_command * (command - self.neutral)
    }
}

/// A servo, as numbers or with derivatives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ServoParameters<S = f64> {
    /// d \[s\].
    pub delay_s: S,
    /// Where it knows a command at the end of its pulse: what the length of that adds to d.
    pub pulse_end: Option<PulseEnd>,
    /// k (1/s²).
    pub stiffness: S,
    /// c (1/s).
    pub damping: S,
    /// Output for each unit of θ.
    pub gain: S,
    /// Output at θ = 0.
    pub offset: S,
    /// The limits of the drive, if it has any.
    pub limit: Option<DriveLimit<S>>,
    /// The limits of the speed, if it has any.
    pub speed_limit: Option<SpeedLimit<S>>,
    /// w \[units of the command\].
    pub dead_band: Option<S>,
    /// Friction, if there is any.
    pub friction: Option<Friction<S>>,
    /// The load.
    pub load: Load<S>,
    /// b, the whole width of the play between the shaft that the controller knows and the output \[units of the command\].
    pub play: Option<S>,
    /// The stops.
    pub stops: Stops,
}

impl ServoParameters<f64> {
    /// A servo of second order with `stiffness` (1/s²) and `damping` (1/s), without delay, limits, friction and load, whose output is θ.
    #[must_use]
    pub fn linear(stiffness: f64, damping: f64) -> Self {
        Self {
            delay_s: 0.0,
            pulse_end: None,
            stiffness,
            damping,
            gain: 1.0,
            offset: 0.0,
            limit: None,
            speed_limit: None,
            dead_band: None,
            friction: None,
            load: Load::None,
            play: None,
            stops: Stops::default(),
        }
    }

    /// The error at which friction holds the shaft at rest without load \[units of the command\]: that of the gears then takes its share of the
    /// drive. `None` without friction, and where the gears hold any drive.
    #[must_use]
    pub fn resting_error(&self) -> Option<f64> {
        let friction = self.friction?;
        let at_rest = 1.0 + friction.at_rest.map_or(0.0, |at_rest| at_rest.excess);
        let left_of_drive = 1.0 - friction.of_gears * at_rest;
        (left_of_drive > 0.0).then(|| friction.coulomb * at_rest / left_of_drive / self.stiffness)
    }

    /// The speeds towards larger and smaller θ at which full drive, damping, friction and `load` \[acceleration\] balance \[units of
    /// the command/s\], or at which they are cut off; 0 where the load holds the drive. `None` without a limit.
    #[must_use]
    pub fn top_speeds(&self, load: f64) -> Option<[f64; 2]> {
        let cut_off = self.speed_limit.map(|limit| limit.both_ways());
        let Some(limit) = self.drive_limit() else {
            return cut_off;
        };
        let friction = |through_gears: f64| {
            (self.friction).map_or(0.0, |friction| friction.in_motion(through_gears))
        };
        let net = |drive: f64, load: f64| (drive - load - friction(drive + load)).max(0.0);
        let [up, down] = limit.both_ways();
        let net = [net(up, load), net(down, -load)];
        Some(match cut_off {
            None => net.map(|net| net / limit.motor_damping),
            Some([up, down]) => {
                let of = |net: f64, speed: f64| if net > 0.0 { speed } else { 0.0 };
                [of(net[0], up), of(net[1], down)]
            }
        })
    }

    /// The largest speed towards larger θ without friction and load \[units of the command/s\]; `None` without a limit.
    #[must_use]
    pub fn free_speed(&self) -> Option<f64> {
        let cut_off = self.speed_limit.map(|limit| limit.up);
        cut_off.or_else(|| self.limit.map(|limit| limit.up / limit.motor_damping))
    }

    /// What belongs to larger and smaller θ as what belongs to upwards and downwards: the output falls with θ where the gain is
    /// negative.
    #[must_use]
    pub fn upwards_first<T>(&self, [larger, smaller]: [T; 2]) -> [T; 2] {
        match self.gain < 0.0 {
            true => [smaller, larger],
            false => [larger, smaller],
        }
    }
}

/// Places of the parameters in [`ServoParameters::in_order`].
pub(crate) mod place {
    pub(crate) const DELAY: usize = 0;
    pub(crate) const STIFFNESS: usize = 1;
    pub(crate) const DAMPING: usize = 2;
    pub(crate) const GAIN: usize = 3;
    pub(crate) const OFFSET: usize = 4;
    pub(crate) const UP: usize = 5;
    pub(crate) const DOWN_TO_UP: usize = 6;
    pub(crate) const MOTOR_DAMPING: usize = 7;
    pub(crate) const DEAD_BAND: usize = 8;
    pub(crate) const COULOMB: usize = 9;
    pub(crate) const OF_GEARS: usize = 10;
    pub(crate) const EXCESS_AT_REST: usize = 11;
    pub(crate) const SPEED_AT_REST: usize = 12;
    /// The first of three.
    pub(crate) const LOAD: usize = 13;
    pub(crate) const PLAY: usize = 16;
    /// A speed limit is at the places of what does not count beside it.
    pub(crate) const SPEED_UP: usize = MOTOR_DAMPING;
    pub(crate) const SPEED_DOWN_TO_UP: usize = DOWN_TO_UP;
}

impl<S: Scalar> ServoParameters<S> {
    /// The same servo without its stops.
    #[must_use]
    pub fn without_stops(self) -> Self {
        Self {
            stops: Stops::default(),
            ..self
        }
    }

    /// The limit of the drive, without what does not count beside a [`SpeedLimit`].
    #[must_use]
    pub fn drive_limit(&self) -> Option<DriveLimit<S>> {
        let alone = self.speed_limit.is_none();
        self.limit.map(|limit| match alone {
            true => limit,
            false => DriveLimit {
                up: limit.up,
                down_to_up: S::constant(1.0),
                motor_damping: S::constant(0.0),
                at_one_stiffness: false,
            },
        })
    }

    /// The same servo behind a sensor whose zero is `higher` \[output\]: it moves alike, and all outputs are as much higher.
    #[must_use]
    pub fn seen_from(mut self, higher: f64) -> Self {
        self.offset = self.offset + S::constant(higher);
        self.stops = self.stops.seen_from(higher);
        self
    }

    /// All numbers, in one order for all servos; 0 for those that this one does not have.
    #[must_use]
    pub fn in_order(&self) -> [S; PARAMETERS] {
        let mut all = [S::constant(0.0); PARAMETERS];
        all[place::DELAY] = self.delay_s;
        all[place::STIFFNESS] = self.stiffness;
        all[place::DAMPING] = self.damping;
        all[place::GAIN] = self.gain;
        all[place::OFFSET] = self.offset;
        if let Some(limit) = self.drive_limit() {
            all[place::UP] = limit.up;
            all[place::DOWN_TO_UP] = limit.down_to_up;
            all[place::MOTOR_DAMPING] = limit.motor_damping;
        }
        if let Some(limit) = self.speed_limit {
            all[place::SPEED_UP] = limit.up;
            all[place::SPEED_DOWN_TO_UP] = limit.down_to_up;
        }
        if let Some(width) = self.dead_band {
            all[place::DEAD_BAND] = width;
        }
        if let Some(friction) = self.friction {
            all[place::COULOMB] = friction.coulomb;
            all[place::OF_GEARS] = friction.of_gears;
            if let Some(at_rest) = friction.at_rest {
                all[place::EXCESS_AT_REST] = at_rest.excess;
                all[place::SPEED_AT_REST] = at_rest.speed;
            }
        }
        all[place::LOAD..place::PLAY].copy_from_slice(&self.load.in_order());
        if let Some(width) = self.play {
            all[place::PLAY] = width;
        }
        all
    }

    /// The same servo in other numbers: `number` makes one of each place in [`Self::in_order`] and what is there.
    pub(crate) fn map<T: Scalar>(&self, number: impl Fn(usize, S) -> T) -> ServoParameters<T> {
        let load = |n: usize, value: S| number(place::LOAD + n, value);
        ServoParameters {
            delay_s: number(place::DELAY, self.delay_s),
            pulse_end: self.pulse_end,
            stiffness: number(place::STIFFNESS, self.stiffness),
            damping: number(place::DAMPING, self.damping),
            gain: number(place::GAIN, self.gain),
            offset: number(place::OFFSET, self.offset),
            limit: self.limit.map(|limit| DriveLimit {
                up: number(place::UP, limit.up),
                down_to_up: number(place::DOWN_TO_UP, limit.down_to_up),
                motor_damping: number(place::MOTOR_DAMPING, limit.motor_damping),
                at_one_stiffness: limit.at_one_stiffness,
            }),
            speed_limit: self.speed_limit.map(|limit| SpeedLimit {
                up: number(place::SPEED_UP, limit.up),
                down_to_up: number(place::SPEED_DOWN_TO_UP, limit.down_to_up),
            }),
            dead_band: self.dead_band.map(|width| number(place::DEAD_BAND, width)),
            friction: self.friction.map(|friction| Friction {
                coulomb: number(place::COULOMB, friction.coulomb),
                of_gears: number(place::OF_GEARS, friction.of_gears),
                at_rest: friction.at_rest.map(|at_rest| AtRest {
                    excess: number(place::EXCESS_AT_REST, at_rest.excess),
                    speed: number(place::SPEED_AT_REST, at_rest.speed),
                }),
            }),
            load: match self.load {
                Load::None => Load::None,
                Load::Constant(constant) => Load::Constant(load(0, constant)),
                Load::Pendulum {
                    gravity,
                    from,
                    radians,
                } => Load::Pendulum {
                    gravity: load(0, gravity),
                    from: load(1, from),
                    radians: load(2, radians),
                },
                Load::Spring { constant, rate } => Load::Spring {
                    constant: load(0, constant),
                    rate: load(1, rate),
                },
                Load::Air {
                    constant,
                    stiffening,
                    from,
                } => Load::Air {
                    constant: load(0, constant),
                    stiffening: load(1, stiffening),
                    from: load(2, from),
                },
            },
            play: self.play.map(|width| number(place::PLAY, width)),
            stops: self.stops,
        }
    }

    /// Half the width of the play.
    #[inline(always)]
    #[must_use]
    pub fn half_play(&self) -> S {
        self.play.map_or(S::constant(0.0), |width| width * 0.5)
    }

    /// The least and the largest θ that the stops leave; infinite where there is none. A stop holds the shaft, and the output is half the play behind it.
    #[must_use]
    pub fn range(&self) -> [S; 2] {
        let ends = [self.stops.lower, self.stops.upper];
        let [low, high] = ends.map(|end| Some((S::constant(end?) - self.offset) / self.gain));
        let [first, last] = match self.gain.value() < 0.0 {
            true => [high, low],
            false => [low, high],
        };
        let half_play = self.half_play();
        let end = |of: Option<S>, half_play: S, open: f64| {
            of.map_or(S::constant(open), |angle| angle + half_play)
        };
        [
            end(first, -half_play, f64::NEG_INFINITY),
            end(last, half_play, f64::INFINITY),
        ]
    }
}
