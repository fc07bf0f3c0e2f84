//! A step of the integration through the [equation](crate::ServoParameters).

use crate::dual::Scalar;
use crate::equation::{AtRest, Friction, Load, ServoParameters};

/// What moves a servo by one step.
pub(crate) trait Advance {
    /// What it moves.
    type State;
    /// The command that acts during the step.
    type Command: Copy;

    /// A command of the record.
    fn command(value: f64) -> Self::Command;

    /// Moves `state` by one step under `command`.
    fn advance(&self, state: &mut Self::State, command: Self::Command);

    /// The speed of the shaft.
    fn speed(state: &Self::State) -> f64;
}

/// Angle and speed of the shaft.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State<S> {
    /// θ \[units of the command\].
    pub angle: S,
    /// ω \[the same for each second\].
    pub speed: S,
    /// φ, the angle that the output shows: θ, or up to half the play beside it.
    pub shown: S,
}

impl<S: Scalar> State<S> {
    /// At rest at `angle`, in the middle of the play.
    #[must_use]
    pub fn at_rest(angle: S) -> Self {
        Self {
            angle,
            speed: S::constant(0.0),
            shown: angle,
        }
    }

    /// φ where the shaft has taken it along, half the play behind.
    #[inline(always)]
    fn taken_along(&self, half_play: S) -> S {
        let ahead = self.angle - self.shown;
        if ahead.value() > half_play.value() {
            self.angle - half_play
        } else if ahead.value() < -half_play.value() {
            self.angle + half_play
        } else {
            self.shown
        }
    }

    /// The output of the servo `physics`.
    #[inline(always)]
    #[must_use]
    pub fn output(&self, physics: &ServoParameters<S>) -> S {
        let shown = match physics.play {
            None => self.angle,
            Some(width) => self.taken_along(width * 0.5),
        };
        shown * physics.gain + physics.offset
    }
}

/// One side of the drive: what a step of the integration needs of it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct DriveSide<S> {
    /// Change of speed for each unit of error, h k.
    pub(crate) stiffness: S,
    /// What the loop's part of the damping takes of the speed at each end of the step, h (c - B)/2.
    pub(crate) braking: S,
    /// 1/(1 + h B/2 + the loop's part).
    pub(crate) proportional: S,
    /// The largest change of speed, h A; `None` without a limit.
    pub(crate) largest: Option<S>,
    /// The strength of its loop relative to that upwards.
    pub(crate) of_loop: S,
    /// Its limit relative to that upwards.
    pub(crate) of_limit: S,
    /// 1 upwards, -1 downwards.
    pub(crate) sign: f64,
}

/// The effect of the drive in a step, as changes of speed.
pub(crate) struct Driven<'a, S> {
    /// The side that drives.
    pub(crate) side: &'a DriveSide<S>,
    /// Whether it drives as hard as it can.
    pub(crate) full: bool,
    /// What it adds, but for the loop's braking with the speed at the end.
    pub(crate) push: S,
    /// The factor by which damping, that braking among it, leaves the sum.
    pub(crate) damped: S,
    /// The whole.
    pub(crate) drive: S,
}

/// Where a speed is beyond its limit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum TooFast {
    /// Towards larger angles.
    Larger,
    /// Towards smaller ones.
    Smaller,
}

/// A step of a certain length through the equation.
///
/// The angle moves by half a step, the speed by a whole one under the forces at that angle, and the angle by the other half
/// (leapfrog); damping acts on the mean of the speeds before and after (Crank-Nicolson). The error is of second order in
/// the length of the step, and a servo whose damping ratio is above ωh/4 stays stable.
#[derive(Clone, Copy, Debug)]
pub struct Stepper<S> {
    pub(crate) step_s: S,
    pub(crate) up: DriveSide<S>,
    pub(crate) down: DriveSide<S>,
    /// 1 - h B/2.
    pub(crate) coasting: S,
    /// 1/(1 + h B/2).
    pub(crate) saturated: S,
    pub(crate) dead_band: Option<S>,
    pub(crate) friction: Option<Friction<S>>,
    pub(crate) load: Load<S>,
    /// Half the play.
    pub(crate) half_play: Option<S>,
    /// The least and the largest angle, infinite without stops.
    pub(crate) range: [S; 2],
    /// The largest speeds towards larger and smaller angles, infinite without a limit.
    pub(crate) fastest: [S; 2],
}

impl<S: Scalar> Stepper<S> {
    /// For the servo `physics`, and a step of `step_s` seconds.
    #[must_use]
    pub fn new(physics: &ServoParameters<S>, step_s: S) -> Self {
        let one = S::constant(1.0);
        let limit = physics.drive_limit();
        let motor = limit.map_or(S::constant(0.0), |limit| limit.motor_damping);
        let half_motor = motor * step_s * 0.5;
        let side = |of_loop: S, of_limit: S, sign: f64| {
            let braking = (physics.damping - motor) * of_loop * step_s * 0.5;
            DriveSide {
                stiffness: physics.stiffness * of_loop * step_s,
                braking,
                proportional: one / (one + half_motor + braking),
                largest: limit.map(|limit| limit.up * of_limit * step_s * sign),
                of_loop,
                of_limit,
                sign,
            }
        };
        let [loop_down, limit_down] = limit.map_or([one; 2], |limit| {
            [limit.loop_down_to_up(), limit.down_to_up]
        });
        Self {
            step_s,
            up: side(one, one, 1.0),
            down: side(loop_down, limit_down, -1.0),
            coasting: one - half_motor,
            saturated: one / (one + half_motor),
            dead_band: physics.dead_band,
            friction: physics.friction,
            load: physics.load,
            half_play: physics.play.map(|width| width * 0.5),
            range: physics.range(),
            fastest: match physics.speed_limit {
                None => [S::constant(f64::INFINITY); 2],
                Some(limit) => limit.both_ways(),
            },
        }
    }

    /// The same without the limit of the drive towards larger or smaller θ.
    #[must_use]
    pub fn without_limit(mut self, towards_larger: bool) -> Self {
        let side = if towards_larger {
            &mut self.up
        } else {
            &mut self.down
        };
        side.largest = None;
        self
    }

    /// The same without the limit of the speed towards larger or smaller θ.
    #[must_use]
    pub fn without_speed_limit(mut self, towards_larger: bool) -> Self {
        self.fastest[usize::from(!towards_larger)] = S::constant(f64::INFINITY);
        self
    }

    /// The same with the limit of the drive towards smaller θ times `factor`, at one stiffness.
    #[must_use]
    pub fn with_limit_downwards(mut self, factor: S) -> Self {
        self.down.largest = self.down.largest.map(|most| most * factor);
        self
    }

    /// One step under the command `command`.
    #[inline(always)]
    pub fn advance(&self, state: &mut State<S>, command: S) {
        self.advance_by(state, command, |moved, _| moved);
    }

    /// The same where `motor` gives the speed at the end of the step, without friction, from that which the equation gives, and from that under the load alone.
    #[inline(always)]
    pub fn advance_by(&self, state: &mut State<S>, command: S, motor: impl FnOnce(S, S) -> S) {
        if let Some(half_play) = self.half_play {
            state.shown = state.taken_along(half_play);
        }
        let half_s = self.step_s * 0.5;
        let middle = state.angle + state.speed * half_s;
        let error = self.beyond_dead_band(command - middle);
        let coasting = state.speed * self.coasting;
        let load = match self.load {
            Load::None => S::constant(0.0),
            load => load.at(middle) * self.step_s,
        };
        let loaded = coasting - load;
        let Driven {
            push,
            damped,
            drive,
            ..
        } = self.drive(error, state.speed, loaded);
        let free = motor((loaded + push) * damped, state.speed - load);
        let speed = match self.friction {
            None => free,
            Some(friction) => {
                let most = self.friction_in_motion(friction, drive + load) * damped;
                braked(state.speed, free, most, friction.at_rest)
            }
        };
        let before = state.speed;
        state.speed = match self.limit_below(speed.value()) {
            None => speed,
            Some(TooFast::Larger) => self.fastest[0],
            Some(TooFast::Smaller) => -self.fastest[1],
        };
        state.angle = middle + state.speed * half_s;
        if cuts(before.value(), state.speed.value(), speed.value()) {
            // It comes to the limit within the step, and stays there for the rest of it.
            let limit = state.speed;
            let missed = (limit - before) * (speed - limit) / (speed - before);
            state.angle = state.angle + missed * half_s;
        }
        if let Some(end) = self.stop_before(state.angle.value()) {
            (state.angle, state.speed) = (end, S::constant(0.0));
        }
    }

    /// The stop that the angle `angle` lies beyond.
    #[inline(always)]
    pub(crate) fn stop_before(&self, angle: f64) -> Option<S> {
        let [low, high] = self.range;
        if angle < low.value() {
            Some(low)
        } else if angle > high.value() {
            Some(high)
        } else {
            None
        }
    }

    /// The side on which the limit of the speed is below `speed`.
    #[inline(always)]
    pub(crate) fn limit_below(&self, speed: f64) -> Option<TooFast> {
        let [larger, smaller] = self.fastest;
        if speed > larger.value() {
            Some(TooFast::Larger)
        } else if speed < -smaller.value() {
            Some(TooFast::Smaller)
        } else {
            None
        }
    }

    /// The error as the controller sees it.
    #[inline(always)]
    pub(crate) fn beyond_dead_band(&self, error: S) -> S {
        match self.dead_band {
            None => error,
            Some(width) => nearer_zero(error, width),
        }
    }

    /// The effect of the drive in a step.
    #[inline(always)]
    pub(crate) fn drive(&self, error: S, speed: S, loaded: S) -> Driven<'_, S> {
        let up = self.up.unlimited(error, speed, loaded);
        let (drive, side) = if up.value() >= 0.0 {
            (up, &self.up)
        } else {
            (self.down.unlimited(error, speed, loaded), &self.down)
        };
        match side.largest {
            Some(most) if drive.value().abs() > most.value().abs() => Driven {
                side,
                full: true,
                push: most,
                damped: self.saturated,
                drive: most,
            },
            _ => Driven {
                side,
                full: false,
                push: error * side.stiffness - speed * side.braking,
                damped: side.proportional,
                drive,
            },
        }
    }

    /// Change of speed in a step that friction takes at speed, where drive and load together change it by `through_gears`.
    #[inline(always)]
    pub(crate) fn friction_in_motion(&self, friction: Friction<S>, through_gears: S) -> S {
        friction.coulomb * self.step_s + through_gears.abs() * friction.of_gears
    }
}

/// The speed at the end of a step that `before` is the speed at the beginning of, and `free` that at the end without friction; friction at speed takes `most` of it.
///
/// Friction is that at the speed in the middle of the step. Where the shaft comes to rest within the step, friction has the other direction, or holds
/// it, for what is left of the step: with one direction for all of it the error were of first order.
#[inline(always)]
pub(crate) fn braked<S: Scalar>(before: S, free: S, most: S, at_rest: Option<AtRest<S>>) -> S {
    let friction_at = |speed: S| match at_rest {
        None => most,
        Some(at_rest) => most * at_rest.factor(speed),
    };
    let from_rest = |change: S| {
        let slow = nearer_zero(change, friction_at(S::constant(0.0)));
        match slow.value() {
            0.0 => slow,
            speed => change - friction_at(slow * 0.5) * speed.signum(),
        }
    };
    if before.value() == 0.0 {
        return from_rest(free);
    }
    let direction = before.value().signum();
    let slowed = free - friction_at(before) * direction;
    let middle = match slowed.value() * direction > 0.0 {
        true => (before + slowed) * 0.5,
        false => before * 0.5,
    };
    let after = free - friction_at(middle) * direction;
    if after.value() * direction >= 0.0 {
        return after;
    }
    let left = after / (after - before);
    from_rest(free - before) * left
}

/// Whether a limit of the speed cuts a step off that goes from the speed `before` to `free` without it, and to `after` with it.
#[inline(always)]
pub(crate) fn cuts(before: f64, after: f64, free: f64) -> bool {
    after != free && after != before
}

/// `value` moved towards zero by `width`, and zero where it would pass it.
#[inline(always)]
pub(crate) fn nearer_zero<S: Scalar>(value: S, width: S) -> S {
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

impl<S: Scalar> Advance for Stepper<S> {
    type State = State<S>;
    type Command = S;

    #[inline(always)]
    fn command(value: f64) -> S {
        S::constant(value)
    }

    #[inline(always)]
    fn advance(&self, state: &mut State<S>, command: S) {
        Stepper::advance(self, state, command);
    }

    #[inline(always)]
    fn speed(state: &State<S>) -> f64 {
        state.speed.value()
    }
}
