//! The [step](Stepper) with its derivatives by the parameters.
//!
//! A step makes angle and speed anew from angle, speed, command and parameters. Its partial derivatives by these are few and
//! scalar; those by the parameters through the steps before follow by the chain rule, two multiplications for each parameter. A
//! [dual](crate::Dual) number carries all derivatives through every operation instead.

use crate::dual::Dual;
use crate::equation::{AtRest, PARAMETERS, ServoParameters, Slopes, place};
use crate::start::Start;
use crate::stepper::{Advance, Driven, State, Stepper, TooFast, braked, cuts};

/// Angle and speed of the shaft, with their derivatives by the parameters.
pub(crate) struct SlopedState {
    plain: State<f64>,
    angle: Slopes,
    speed: Slopes,
    shown: Slopes,
    /// Its derivatives by the zero of the sensor: those by the offset, but that stops stay where they are.
    by_zero: State<f64>,
}

impl SlopedState {
    /// The state in which a simulation begins.
    pub(crate) fn new(physics: &ServoParameters<f64>, start: &Start<f64>) -> Self {
        let plain = physics.state_at(start);
        let shown = of_output(physics, plain.shown);
        let (mut angle, mut speed) = (shown, Slopes::default());
        angle[place::PLAY] = physics.play.map_or(0.0, |_| 0.5 * start.in_play);
        speed[place::GAIN] = -plain.speed / physics.gain;
        Self {
            plain,
            angle,
            speed,
            shown,
            by_zero: State {
                speed: 0.0,
                ..State::at_rest(-1.0 / physics.gain)
            },
        }
    }

    /// Takes all speed at a stop, whose output is known, at the angle `end`.
    fn stop(&mut self, physics: &ServoParameters<f64>, end: f64) {
        let side = match end > self.plain.angle {
            true => -0.5,
            false => 0.5,
        };
        (self.plain.angle, self.plain.speed) = (end, 0.0);
        self.angle = of_output(physics, end - 2.0 * side * physics.half_play());
        self.angle[place::PLAY] = physics.play.map_or(0.0, |_| side);
        self.speed = Slopes::default();
        (self.by_zero.angle, self.by_zero.speed) = (0.0, 0.0);
    }

    /// φ where the shaft takes it along, with its derivatives.
    #[inline(always)]
    fn take_along(&mut self, half_play: f64) {
        let ahead = self.plain.angle - self.plain.shown;
        if ahead.abs() <= half_play {
            return;
        }
        let side = ahead.signum();
        self.plain.shown = self.plain.angle - side * half_play;
        self.shown = self.angle;
        self.shown[place::PLAY] -= 0.5 * side;
        self.by_zero.shown = self.by_zero.angle;
    }

    /// The command that holds the shaft where it is.
    pub(crate) fn holding_command(&self, physics: &ServoParameters<f64>) -> (f64, Slopes) {
        let lifted = physics.map(|place, value| Dual::<PARAMETERS>::variable(value, place));
        let angle = Dual {
            value: self.plain.angle,
            slope: self.angle,
        };
        let Dual { value, slope } = lifted.holding_command(angle);
        (value, slope)
    }

    /// The measured output, with its derivatives by the parameters and by the zero of the sensor.
    #[inline(always)]
    pub(crate) fn output(&self, physics: &ServoParameters<f64>) -> (f64, Slopes, f64) {
        let (angle, by_parameters, by_zero) = match physics.play {
            None => (self.plain.angle, &self.angle, self.by_zero.angle),
            Some(_) => (self.plain.shown, &self.shown, self.by_zero.shown),
        };
        let mut slopes = by_parameters.map(|slope| slope * physics.gain);
        slopes[place::GAIN] += angle;
        slopes[place::OFFSET] += 1.0;
        let output = angle * physics.gain + physics.offset;
        (output, slopes, by_zero * physics.gain + 1.0)
    }
}

/// The derivatives of an angle that follows from an output.
fn of_output(physics: &ServoParameters<f64>, angle: f64) -> Slopes {
    let per_output = 1.0 / physics.gain;
    let mut slopes = Slopes::default();
    slopes[place::OFFSET] = -per_output;
    slopes[place::GAIN] = -angle * per_output;
    slopes
}

/// A command, with derivatives where it follows from the parameters.
#[derive(Clone, Copy)]
pub(crate) struct SlopedCommand<'a> {
    pub(crate) value: f64,
    pub(crate) slopes: Option<&'a Slopes>,
}

/// A step, with what its derivatives need.
pub(crate) struct SlopedStepper<'a> {
    plain: Stepper<f64>,
    physics: &'a ServoParameters<f64>,
    /// B, 0 without a limit.
    motor_damping: f64,
    /// Derivative of the length of the step by the delay.
    by_delay: f64,
}

impl<'a> SlopedStepper<'a> {
    pub(crate) fn new(physics: &'a ServoParameters<f64>, step_s: f64, by_delay: f64) -> Self {
        Self {
            plain: Stepper::new(physics, step_s),
            physics,
            motor_damping: (physics.drive_limit()).map_or(0.0, |limit| limit.motor_damping),
            by_delay,
        }
    }
}

/// What acts in a step, as changes of speed.
struct Forces<'a> {
    /// The error beyond the dead band.
    error: f64,
    /// What the load takes.
    load: f64,
    /// What the motor's damping and the load leave of the speed.
    loaded: f64,
    driven: Driven<'a, f64>,
    /// What friction at speed takes, but for what damping leaves of it.
    friction: f64,
}

/// Derivatives of the speed after a step by what [`braked`] makes it of.
struct Braked {
    /// By the speed before the step.
    before: f64,
    /// By that without friction.
    free: f64,
    /// By what friction at speed takes.
    friction: f64,
    /// By the excess of friction at rest, and by the speed where half of that is gone.
    at_rest: [f64; 2],
}

impl Braked {
    /// Without friction.
    const FREE: Self = Self {
        before: 0.0,
        free: 1.0,
        friction: 0.0,
        at_rest: [0.0; 2],
    };

    /// [`braked`], with its derivatives.
    #[inline(always)]
    fn of(before: f64, free: f64, most: f64, at_rest: Option<AtRest<f64>>) -> (f64, Self) {
        let variable = |place, value| Dual::<5>::variable(value, place);
        let at_rest = at_rest.map(|at_rest| AtRest {
            excess: variable(3, at_rest.excess),
            speed: variable(4, at_rest.speed),
        });
        let after = braked(
            variable(0, before),
            variable(1, free),
            variable(2, most),
            at_rest,
        );
        let [before, free, friction, excess, speed_at_rest] = after.slope;
        let by = Self {
            before,
            free,
            friction,
            at_rest: [excess, speed_at_rest],
        };
        (after.value, by)
    }
}

/// Derivatives of the speed after a step.
#[derive(Default)]
struct ByInputs {
    /// By the angle in the middle of the step.
    middle: f64,
    /// By the speed before the step, that angle held.
    speed: f64,
    /// By the command.
    command: f64,
    /// By the length of the step, that angle held.
    length: f64,
    /// By the parameters.
    parameters: Slopes,
}

impl SlopedStepper<'_> {
    #[inline(always)]
    fn forces(&self, speed: f64, middle: f64, command: f64) -> Forces<'_> {
        let plain = &self.plain;
        let error = plain.beyond_dead_band(command - middle);
        let load = plain.load.at(middle) * plain.step_s;
        let loaded = speed * plain.coasting - load;
        let driven = plain.drive(error, speed, loaded);
        let friction = (plain.friction).map_or(0.0, |friction| {
            plain.friction_in_motion(friction, driven.drive + load)
        });
        Forces {
            error,
            load,
            loaded,
            driven,
            friction,
        }
    }

    /// The speed after the step, without its limit; no derivatives where the shaft sticks.
    #[inline(always)]
    fn free_speed_after(&self, speed: f64, middle: f64, command: f64) -> (f64, Option<ByInputs>) {
        let forces = self.forces(speed, middle, command);
        let damped = forces.driven.damped;
        let free = (forces.loaded + forces.driven.push) * damped;
        let (after, braked) = match self.plain.friction {
            None => (free, Braked::FREE),
            Some(friction) => {
                let most = forces.friction * damped;
                let (after, braked) = Braked::of(speed, free, most, friction.at_rest);
                if after == 0.0 {
                    return (0.0, None);
                }
                (after, braked)
            }
        };
        (after, Some(self.by_inputs(speed, middle, &forces, &braked)))
    }

    /// The speed at its limit, which depends on nothing else.
    fn limited_speed(&self, side: TooFast) -> (f64, ByInputs) {
        let mut by = ByInputs::default();
        let [larger, smaller] = self.plain.fastest;
        let limit = match side {
            TooFast::Larger => {
                by.parameters[place::SPEED_UP] = 1.0;
                larger
            }
            TooFast::Smaller => {
                by.parameters[place::SPEED_UP] = -smaller / larger;
                by.parameters[place::SPEED_DOWN_TO_UP] = -larger;
                -smaller
            }
        };
        (limit, by)
    }

    /// What the angle moves further in a step in which the speed comes to its limit, as it stays there for the rest of it: with ω before, V the limit
    /// and f the speed without it, h/2 (V - ω) (f - V)/(f - ω).
    fn after_cut(
        &self,
        speed: f64,
        (free, by_free): (f64, &ByInputs),
        (limit, by_limit): (f64, &ByInputs),
    ) -> (f64, ByInputs) {
        let half_s = 0.5 * self.plain.step_s;
        let [until, rest] = [limit - speed, free - limit].map(|part| part / (free - speed));
        let moved = until * (free - limit);
        let [by_before, by_without, by_v] =
            [-rest * rest, until * until, rest - until].map(|by| by * half_s);
        let mut by = ByInputs {
            middle: by_without * by_free.middle,
            speed: by_before + by_without * by_free.speed,
            command: by_without * by_free.command,
            length: 0.5 * moved + by_without * by_free.length,
            parameters: by_free.parameters.map(|slope| by_without * slope),
        };
        for (slope, of_limit) in by.parameters.iter_mut().zip(by_limit.parameters) {
            *slope += by_v * of_limit;
        }
        (moved * half_s, by)
    }

    /// With D the damping, x = `loaded`, p = `push` and F the friction, the speed after the step is that which is [`braked`] from D (x + p) by D F.
    #[inline(always)]
    fn by_inputs(&self, speed: f64, middle: f64, forces: &Forces<'_>, braked: &Braked) -> ByInputs {
        let plain = &self.plain;
        let (step_s, half_s) = (plain.step_s, plain.step_s * 0.5);
        let Driven {
            side, push, damped, ..
        } = forces.driven;
        // The change by what turns the gears: F = h C + |drive + load| μ.
        let of_gears = plain.friction.map_or(0.0, |friction| friction.of_gears);
        let through_gears = forces.driven.drive + forces.load;
        let turned = braked.friction * of_gears * through_gears.signum();
        let sum = forces.loaded + push;
        let whole = braked.free * sum + braked.friction * forces.friction;

        let mut by = ByInputs::default();
        // By h times the load, by h B/2, by h (c - B)/2, by h k and by h A.
        let (by_load, by_half_motor, by_braking, by_stiffness, by_most);
        if forces.driven.full {
            by_load = damped * (turned - braked.free);
            by_half_motor = -damped * (braked.free * speed + damped * whole);
            by_most = damped * (braked.free + turned) * side.sign;
            (by_braking, by_stiffness) = (0.0, 0.0);
            by.speed = damped * braked.free * plain.coasting;
        } else {
            // drive = p - (x + p) D b with b = h (c - B)/2.
            let looped = turned * damped * side.braking;
            let by_push = damped * (braked.free + turned - looped);
            let by_loaded = damped * (braked.free - looped);
            // D = 1/(1 + h B/2 + b).
            let by_sum_of_dampings = damped * damped * (whole - looped * sum);
            by_load = damped * turned - by_loaded;
            by_half_motor = -by_loaded * speed - by_sum_of_dampings;
            by_braking = -by_push * speed - damped * turned * sum * damped - by_sum_of_dampings;
            by_stiffness = by_push * forces.error;
            by_most = 0.0;
            by.speed = by_loaded * plain.coasting - by_push * side.braking;
            by.command = match forces.error == 0.0 && plain.dead_band.is_some() {
                true => 0.0,
                false => by_push * side.stiffness,
            };
        }
        let (load_by_angle, load_by_own) = plain.load.slopes_at(middle);
        by.middle = by_load * step_s * load_by_angle - by.command;
        let by_friction = braked.friction * damped;
        by.speed += braked.before;

        let physics = self.physics;
        let (of_loop_side, of_limit) = (side.of_loop, side.of_limit);
        let slopes = &mut by.parameters;
        slopes[place::STIFFNESS] = by_stiffness * step_s * of_loop_side;
        slopes[place::DAMPING] = by_braking * half_s * of_loop_side;
        let of_loop = physics.damping - self.motor_damping;
        if let Some(limit) = physics.drive_limit() {
            slopes[place::MOTOR_DAMPING] = (by_half_motor - by_braking * of_loop_side) * half_s;
            slopes[place::UP] = by_most * step_s * of_limit;
            if side.sign < 0.0 {
                slopes[place::DOWN_TO_UP] = by_most * step_s * limit.up;
                if !limit.at_one_stiffness {
                    slopes[place::DOWN_TO_UP] +=
                        by_stiffness * step_s * physics.stiffness + by_braking * half_s * of_loop;
                }
            }
        }
        if physics.speed_limit.is_some() {
            (slopes[place::SPEED_UP], slopes[place::SPEED_DOWN_TO_UP]) = (0.0, 0.0);
        }
        if plain.dead_band.is_some() {
            slopes[place::DEAD_BAND] = -by.command * forces.error.signum();
        }
        slopes[place::COULOMB] = by_friction * step_s;
        slopes[place::OF_GEARS] = by_friction * through_gears.abs();
        [slopes[place::EXCESS_AT_REST], slopes[place::SPEED_AT_REST]] = braked.at_rest;
        let of_load = &mut slopes[place::LOAD..place::PLAY];
        for (slope, own) in of_load.iter_mut().zip(load_by_own) {
            *slope = by_load * step_s * own;
        }
        if self.by_delay != 0.0 {
            let coulomb = plain.friction.map_or(0.0, |friction| friction.coulomb);
            let limit_up = physics.limit.map_or(0.0, |limit| limit.up);
            by.length = by_stiffness * physics.stiffness * of_loop_side
                + by_braking * of_loop * of_loop_side * 0.5
                + by_half_motor * self.motor_damping * 0.5
                + by_most * limit_up * of_limit
                + by_load * plain.load.at(middle)
                + by_friction * coulomb;
        }
        by
    }
}

impl<'a> Advance for SlopedStepper<'a> {
    type State = SlopedState;
    type Command = SlopedCommand<'a>;

    fn command(value: f64) -> SlopedCommand<'a> {
        SlopedCommand {
            value,
            slopes: None,
        }
    }

    // Once in the program: a copy at each of its calls outgrows the processor's cache.
    #[inline(never)]
    fn advance(&self, state: &mut SlopedState, command: SlopedCommand<'a>) {
        let half_s = self.plain.step_s * 0.5;
        let State { angle, speed, .. } = state.plain;
        let middle = angle + speed * half_s;
        let (free, by) = self.free_speed_after(speed, middle, command.value);
        let by = by.unwrap_or_default();
        let (mut after, mut further) = (free, None);
        let (slopes, by_zero) = match self.plain.limit_below(free) {
            None => self.by_state(&by, state, command),
            Some(side) => {
                let (limit, by_limit) = self.limited_speed(side);
                after = limit;
                further = cuts(speed, limit, free).then(|| {
                    let (moved, by) = self.after_cut(speed, (free, &by), (limit, &by_limit));
                    (moved, self.by_state(&by, state, command))
                });
                self.by_state(&by_limit, state, command)
            }
        };
        let zero = &mut state.by_zero;
        zero.angle += (zero.speed + by_zero) * half_s;
        zero.speed = by_zero;
        for (i, slope) in state.angle.iter_mut().enumerate() {
            *slope += (state.speed[i] + slopes[i]) * half_s;
        }
        state.angle[place::DELAY] += (speed + after) * 0.5 * self.by_delay;
        state.speed = slopes;
        state.plain.angle = middle + after * half_s;
        state.plain.speed = after;
        if let Some((moved, (slopes, by_zero))) = further {
            state.plain.angle += moved;
            state.by_zero.angle += by_zero;
            for (slope, more) in state.angle.iter_mut().zip(slopes) {
                *slope += more;
            }
        }
        if let Some(end) = self.plain.stop_before(state.plain.angle) {
            state.stop(self.physics, end);
        }
        if let Some(half_play) = self.plain.half_play {
            state.take_along(half_play);
        }
    }

    #[inline(always)]
    fn speed(state: &SlopedState) -> f64 {
        state.plain.speed
    }
}

impl SlopedStepper<'_> {
    /// The derivatives by the parameters, and by the zero of the sensor, of what has these by the inputs of a step from `state`.
    #[inline(always)]
    fn by_state(
        &self,
        by: &ByInputs,
        state: &SlopedState,
        command: SlopedCommand<'_>,
    ) -> (Slopes, f64) {
        let half_s = self.plain.step_s * 0.5;
        let by_speed = by.speed + by.middle * half_s;
        let mut slopes = by.parameters;
        for (i, slope) in slopes.iter_mut().enumerate() {
            *slope += by.middle * state.angle[i] + by_speed * state.speed[i];
        }
        if let Some(of_command) = command.slopes {
            for (slope, of_command) in slopes.iter_mut().zip(of_command) {
                *slope += by.command * of_command;
            }
        }
        let zero = &state.by_zero;
        let of_command = command.slopes.map_or(0.0, |slopes| slopes[place::OFFSET]);
        let by_zero = by.middle * zero.angle + by_speed * zero.speed + by.command * of_command;
        // The middle moves with the length of the step too.
        slopes[place::DELAY] += (by.length + by.middle * state.plain.speed * 0.5) * self.by_delay;
        (slopes, by_zero)
    }
}
