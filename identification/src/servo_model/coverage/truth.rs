//! Servos that are computed apart from the model: their own scheme, finer steps, and parts that the equation does not have.

use crate::servo_model::descent::coordinates::Point;
use servoid_dynamics::ServoParameters;

/// Step of the integration \[s\]: a tenth of the shortest that the model takes.
const STEP_S: f64 = 2e-5;

/// Time in which a servo of these tests reaches its top speed \[s\]: more than ten times 1/B.
const LONG_STROKE_S: f64 = 3.0;

/// A command that no servo of these tests reaches within that time.
const FAR: f64 = 1e6;

/// What a servo has that the equation does not have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Beyond {
    /// Nothing: it is of the model's class.
    Nothing,
    /// Friction is 1 + `excess` times Coulomb's below `until`, and Coulomb's beyond it.
    Stiction {
        /// s.
        excess: f64,
        /// Speed \[units of the command for each second\].
        until: f64,
    },
    /// The motor's torque is limited, so that the acceleration at low speed is less than full drive gives.
    CurrentLimit {
        /// The largest torque, as a share of full drive at standstill.
        share: f64,
    },
    /// Where the shaft turns or is driven towards smaller θ, limit of the drive and damping of the motor are these times as large; the controller is
    /// the same.
    UnequalSides {
        /// Of the limit.
        limit: f64,
        /// Of the motor's damping.
        motor: f64,
    },
    /// The current of the motor, and its torque with it, lags by the time that its coil takes.
    DriveLag {
        /// \[s\].
        lag_s: f64,
    },
    /// The drive has steps.
    QuantisedDrive {
        /// One step, as a share of full drive upwards.
        step: f64,
    },
}

/// A servo with a known answer to everything.
#[derive(Clone, Debug)]
pub(super) struct Truth {
    /// Its part within the class.
    pub(super) point: Point,
    /// The rest.
    pub(super) beyond: Beyond,
}

impl Truth {
    /// The output, sampled every `period_s` seconds, under `input`: from rest at its first command, play at its middle.
    pub(super) fn response(&self, input: &[f64], period_s: f64) -> Vec<f64> {
        let machine = Machine::new(self);
        let p = &machine.p;
        let steps = (period_s / STEP_S).round() as usize;
        let delay_steps = (p.delay_s / STEP_S).round() as usize;
        let angle = p.resting_angle(input[0]);
        let mut state = Moving {
            angle,
            speed: 0.0,
            torque: machine.wanted(angle, 0.0, input[0]),
        };
        let mut measured = state.angle;
        let mut output = Vec::with_capacity(input.len());
        for step in 0..input.len() * steps {
            if step % steps == 0 {
                output.push(p.gain * measured + p.offset);
            }
            let command = input[step.saturating_sub(delay_steps) / steps];
            machine.advance(&mut state, command);
            measured = machine.measured(state.angle, measured);
        }
        output
    }

    /// Whether it is of the model's class.
    pub(super) fn is_in_class(&self) -> bool {
        self.beyond == Beyond::Nothing && !self.point.terms.one_stiffness
    }

    /// Speed of the output at the end of a stroke without end upwards or downwards (1/s). Their load is a constant.
    pub(super) fn top_speed(&self, upwards: bool) -> f64 {
        let machine = Machine::new(self);
        let command = if upwards { FAR } else { -FAR };
        let mut state = Moving {
            angle: 0.0,
            speed: 0.0,
            torque: 0.0,
        };
        for _ in 0..(LONG_STROKE_S / STEP_S) as usize {
            machine.advance(&mut state, command);
        }
        (state.speed * machine.p.gain).abs()
    }

    /// The whole number of steps of the integration next to a delay \[s\]: such a delay is exact in it.
    pub(super) fn on_grid(delay_s: f64) -> f64 {
        (delay_s / STEP_S).round() * STEP_S
    }
}

/// Angle and speed of the shaft.
#[derive(Clone, Copy)]
struct Moving {
    angle: f64,
    speed: f64,
    /// Of the motor, for each unit of inertia.
    torque: f64,
}

/// A servo as its integration needs it.
struct Machine {
    p: ServoParameters,
    beyond: Beyond,
}

impl Machine {
    fn new(truth: &Truth) -> Self {
        Self {
            p: truth.point.physics(0, |_, value| value),
            beyond: truth.beyond,
        }
    }

    /// One step of the midpoint rule. A shaft with friction whose speed passes through zero stands still, until more than the
    /// friction at rest acts on it.
    fn advance(&self, state: &mut Moving, command: f64) {
        let half = Moving {
            angle: state.angle + 0.5 * STEP_S * state.speed,
            speed: self.cut_off(state.speed + 0.5 * STEP_S * self.acceleration(*state, command)),
            torque: state.torque + 0.5 * STEP_S * self.rise(*state, command),
        };
        let before = state.speed;
        state.angle += STEP_S * half.speed;
        state.speed = self.cut_off(state.speed + STEP_S * self.acceleration(half, command));
        state.torque += STEP_S * self.rise(half, command);
        if self.p.friction.is_some() && before * state.speed < 0.0 {
            state.speed = 0.0;
        }
    }

    /// The speed, as far as it has no limit.
    fn cut_off(&self, speed: f64) -> f64 {
        match self.p.speed_limit {
            None => speed,
            Some(limit) => {
                let [up, down] = limit.both_ways();
                speed.clamp(-down, up)
            }
        }
    }

    fn acceleration(&self, state: Moving, command: f64) -> f64 {
        let p = &self.p;
        let drive = self.drive(command - state.angle, state.speed);
        let load = p.load.at(state.angle);
        let torque = match self.beyond {
            Beyond::DriveLag { .. } => state.torque,
            _ => self.wanted(state.angle, state.speed, command),
        };
        let free = torque - load;
        let friction = self.friction(state.speed, drive + load);
        if state.speed != 0.0 {
            free - friction * state.speed.signum()
        } else if free.abs() > friction {
            free - friction * free.signum()
        } else {
            0.0
        }
    }

    /// The torque without a lag.
    fn wanted(&self, angle: f64, speed: f64, command: f64) -> f64 {
        let drive = self.drive(command - angle, speed);
        self.torque(drive - self.motor_damping(speed) * speed)
    }

    /// The rate of a torque that lags.
    fn rise(&self, state: Moving, command: f64) -> f64 {
        match self.beyond {
            Beyond::DriveLag { lag_s } => {
                (self.wanted(state.angle, state.speed, command) - state.torque) / lag_s
            }
            _ => 0.0,
        }
    }

    /// What the controller asks for, as far as its supply and its steps allow.
    fn drive(&self, error: f64, speed: f64) -> f64 {
        let p = &self.p;
        let dead_band = p.dead_band.unwrap_or(0.0);
        let seen = error - error.clamp(-dead_band, dead_band);
        let Some(limit) = p.limit else {
            return p.stiffness * seen - p.damping * speed;
        };
        let wanted = p.stiffness * seen - (p.damping - limit.motor_damping) * speed;
        let wanted = match self.beyond {
            Beyond::QuantisedDrive { step } => {
                let step = step * limit.up;
                (wanted / step).round() * step
            }
            _ => wanted,
        };
        let [of_loop, of_limit] = match wanted < 0.0 {
            true => [limit.loop_down_to_up(), limit.down_to_up],
            false => [1.0; 2],
        };
        let most = match self.beyond {
            Beyond::UnequalSides { limit: more, .. } if wanted < 0.0 => limit.up * of_limit * more,
            _ => limit.up * of_limit,
        };
        (wanted * of_loop).clamp(-most, most)
    }

    /// B at a speed.
    fn motor_damping(&self, speed: f64) -> f64 {
        let own = self.p.limit.map_or(0.0, |limit| limit.motor_damping);
        match self.beyond {
            Beyond::UnequalSides { motor, .. } if speed < 0.0 => own * motor,
            _ => own,
        }
    }

    /// What the limit of the current leaves of the motor's torque.
    fn torque(&self, wanted: f64) -> f64 {
        match (self.beyond, self.p.limit) {
            (Beyond::CurrentLimit { share }, Some(limit)) => {
                let most = share * limit.up;
                wanted.clamp(-most * limit.down_to_up, most)
            }
            _ => wanted,
        }
    }

    /// The friction at a speed, while this torque goes through the gears.
    fn friction(&self, speed: f64, through_gears: f64) -> f64 {
        let Some(friction) = self.p.friction else {
            return 0.0;
        };
        let in_motion = friction.coulomb + friction.of_gears * through_gears.abs();
        let excess = match (self.beyond, friction.at_rest) {
            (Beyond::Stiction { excess, until }, _) if speed.abs() < until => excess,
            (Beyond::Stiction { .. }, _) | (_, None) => 0.0,
            (_, Some(at_rest)) => at_rest.excess / (1.0 + (speed / at_rest.speed).powi(2)),
        };
        in_motion * (1.0 + excess)
    }

    /// The measured angle: carried along by the ends of the play.
    fn measured(&self, angle: f64, before: f64) -> f64 {
        let half_play = self.p.half_play();
        before.clamp(angle - half_play, angle + half_play)
    }
}
