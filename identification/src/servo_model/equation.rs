//! The equation of the servo as a machine.
//!
//! A motor behind a position controller, with r the command, u the input of the record, d the delay and y the
//! measured output. θ (in units of the command) is the angle of the shaft and ω its speed:
//!
//! ```text
//! r(t)  = u(t - d)
//! e     = r - θ beyond a dead band of ±w, and counts from its edge
//! drive = k e - (c - B) ω, between -A- and A+            acceleration; k for k A-/A+ where the drive is negative
//! ω'    = drive - B ω - friction - load(θ)
//! θ'    = ω,     y = gain θ + offset
//! ```
//!
//! At small signals this is a second-order system with the stiffness k (1/s²) and the damping c (1/s), of which the
//! motor's own part is B. Where the error exceeds E = A+/k the drive is full. Top speed upwards is then
//! (A+ - friction)/B.
//!
//! Friction is Coulomb's, C, and more at rest: C (1 + s/(1 + (ω/ωs)²)) (D. P. Hess and A. Soom, "Friction at a
//! lubricated line contact operating at oscillating sliding velocities", Journal of Tribology, 1990). It holds the
//! shaft at rest while less than that acts on it, so the resting error depends on the direction of approach, by C/k
//! to each side.

use crate::numerics::Scalar;

/// Steps to the angle of rest: each halves the distance, so the rest is below a millionth of it.
const RESTING_STEPS: usize = 25;

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
        radians: f64,
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

#[expect(private_bounds, reason = "the methods are as private as the trait")]
impl<S: Scalar> Load<S> {
    /// The acceleration that it takes at the angle `angle`.
    #[inline(always)]
    fn at(&self, angle: S) -> S {
        match *self {
            Self::None => S::constant(0.0),
            Self::Constant(constant) => constant,
            Self::Pendulum {
                gravity,
                from,
                radians,
            } => gravity * ((angle + from) * radians).sin(),
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

/// Friction that opposes the motion \[acceleration\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Friction<S> {
    /// C, at speed.
    pub coulomb: S,
    /// What it has more at rest.
    pub at_rest: Option<AtRest<S>>,
}

/// Friction that falls with speed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AtRest<S> {
    /// s: at rest the friction is C (1 + s).
    pub excess: S,
    /// ωs, the speed at which half of the excess is gone.
    pub speed: S,
}

/// The largest drive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DriveLimit<S> {
    /// A+, the largest acceleration upwards.
    pub up: S,
    /// A-/A+.
    pub down_to_up: S,
    /// B, the motor's own damping (1/s): what slows it while the drive is full.
    pub motor_damping: S,
}

/// A servo, as numbers or with derivatives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ServoParameters<S = f64> {
    /// d \[s\].
    pub delay_s: S,
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
    /// w \[units of the command\].
    pub dead_band: Option<S>,
    /// Friction, if there is any.
    pub friction: Option<Friction<S>>,
    /// The load.
    pub load: Load<S>,
}

#[expect(private_bounds, reason = "the methods are as private as the trait")]
impl<S: Scalar> ServoParameters<S> {
    /// The command that holds the shaft at rest at `angle`, without help of friction.
    pub(super) fn holding_command(&self, angle: S) -> S {
        angle + self.load.at(angle) / self.stiffness
    }

    /// The output at rest under `command`, without help of friction: the holding command turned round, by steps that
    /// each take the load at the last angle.
    pub(super) fn resting_output(&self, command: S) -> S {
        let mut angle = command;
        for _ in 0..RESTING_STEPS {
            angle = (angle + command - self.load.at(angle) / self.stiffness) * 0.5;
        }
        angle * self.gain + self.offset
    }
}

/// Angle and speed of the shaft.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct State<S> {
    /// θ \[units of the command\].
    pub(super) angle: S,
    /// ω \[the same for each second\].
    pub(super) speed: S,
}

/// One side of the drive: what a step of the integration needs of it.
#[derive(Clone, Copy, Debug)]
struct DriveSide<S> {
    /// Change of speed for each unit of error, h k.
    stiffness: S,
    /// What the loop's part of the damping takes of the speed at each end of the step, h (c - B)/2.
    braking: S,
    /// 1/(1 + h B/2 + the loop's part).
    proportional: S,
    /// The largest change of speed, h A; `None` without a limit.
    largest: Option<S>,
}

/// A step of a certain length through the equation.
///
/// The angle moves by half a step, the speed by a whole one under the forces at that angle, and the angle by the other half
/// (leapfrog); damping acts on the mean of the speeds before and after (Crank-Nicolson). The error is of second order in
/// the length of the step, and a servo whose damping ratio is above ωh/4 stays stable.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stepper<S> {
    step_s: S,
    up: DriveSide<S>,
    down: DriveSide<S>,
    /// 1 - h B/2.
    coasting: S,
    /// 1/(1 + h B/2).
    saturated: S,
    dead_band: Option<S>,
    friction: Option<Friction<S>>,
    load: Load<S>,
}

impl<S: Scalar> Stepper<S> {
    pub(super) fn new(physics: &ServoParameters<S>, step_s: S) -> Self {
        let one = S::constant(1.0);
        let motor = physics
            .limit
            .map_or(S::constant(0.0), |limit| limit.motor_damping);
        let half_motor = motor * step_s * 0.5;
        let side = |ratio: S, sign: f64| {
            let braking = (physics.damping - motor) * ratio * step_s * 0.5;
            DriveSide {
                stiffness: physics.stiffness * ratio * step_s,
                braking,
                proportional: one / (one + half_motor + braking),
                largest: physics.limit.map(|limit| limit.up * ratio * step_s * sign),
            }
        };
        Self {
            step_s,
            up: side(one, 1.0),
            down: side(physics.limit.map_or(one, |limit| limit.down_to_up), -1.0),
            coasting: one - half_motor,
            saturated: one / (one + half_motor),
            dead_band: physics.dead_band,
            friction: physics.friction,
            load: physics.load,
        }
    }

    /// One step under the command `command`.
    #[inline(always)]
    pub(super) fn advance(&self, state: &mut State<S>, command: S) {
        let half_s = self.step_s * 0.5;
        let middle = state.angle + state.speed * half_s;
        let error = self.beyond_dead_band(command - middle);
        let coasting = state.speed * self.coasting;
        let loaded = match self.load {
            Load::None => coasting,
            load => coasting - load.at(middle) * self.step_s,
        };
        let (push, damped) = self.drive(error, state.speed, loaded);
        let free = (loaded + push) * damped;
        state.speed = match self.friction {
            None => free,
            Some(friction) => self.held_back(friction, state.speed, free, damped),
        };
        state.angle = middle + state.speed * half_s;
    }

    /// The error as the controller sees it.
    #[inline(always)]
    fn beyond_dead_band(&self, error: S) -> S {
        match self.dead_band {
            None => error,
            Some(width) => nearer_zero(error, width),
        }
    }

    /// What the drive adds to the speed in a step, and the factor by which damping leaves the sum.
    #[inline(always)]
    fn drive(&self, error: S, speed: S, loaded: S) -> (S, S) {
        let up = self.up.unlimited(error, speed, loaded);
        let (drive, side) = if up.value() >= 0.0 {
            (up, &self.up)
        } else {
            (self.down.unlimited(error, speed, loaded), &self.down)
        };
        match side.largest {
            Some(most) if drive.value().abs() > most.value().abs() => (most, self.saturated),
            _ => (
                error * side.stiffness - speed * side.braking,
                side.proportional,
            ),
        }
    }

    /// Friction takes speed, and all of it where it holds the shaft.
    #[inline(always)]
    fn held_back(&self, friction: Friction<S>, speed: S, free: S, damped: S) -> S {
        let mut most = friction.coulomb * self.step_s * damped;
        if let Some(at_rest) = friction.at_rest {
            let relative = speed / at_rest.speed;
            let one = S::constant(1.0);
            most = most * (one + at_rest.excess / (one + relative * relative));
        }
        nearer_zero(free, most)
    }
}

/// `value` moved towards zero by `width`, and zero where it would pass it.
#[inline(always)]
fn nearer_zero<S: Scalar>(value: S, width: S) -> S {
    if value.value() > width.value() {
        value - width
    } else if value.value() < -width.value() {
        value + width
    } else {
        S::constant(0.0)
    }
}

impl<S: Scalar> DriveSide<S> {
    /// What an unlimited drive adds to the speed in a step; the loop brakes with the mean of the speeds at its ends.
    #[inline(always)]
    fn unlimited(&self, error: S, speed: S, loaded: S) -> S {
        let push = error * self.stiffness - speed * self.braking;
        push - (loaded + push) * self.proportional * self.braking
    }
}
