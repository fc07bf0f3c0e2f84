//! A servo of the [equation](ServoParameters), such as one that was identified.
//!
//! The motion is integrated in steps of [`STEP`] from one point of a fixed grid to the next; a step ends where a delayed
//! command changes. Reading the angle between these times computes a shorter step of its own and keeps nothing of it, so the
//! motion does not depend on when it is looked at. A missing pulse leaves the command unchanged: recordings of a
//! servo under pulses do not show what it does without them.

use crate::delay_line::DelayLine;
use crate::servo::{SERVO_SCALE, Servo};
use servoid_dynamics::{ServoParameters, State, Stepper};
use servoid_protocol::PulseWidth;
use std::time::Duration;

/// Longest step of the integration: half of the shortest that identification takes, so that the simulated servo is
/// nearer to the equation than the model that is fitted to it.
pub const STEP: Duration = Duration::from_micros(100);

/// A servo of the equation, and what its units are on a rig.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MachineParameters {
    /// The servo, in units of its own.
    pub servo: ServoParameters,
    /// Its command at the neutral pulse \[units of the command\].
    pub neutral_command: f64,
    /// Change of its command for each degree by which the pulse turns \[units of the command per degree\].
    pub command_per_degree: f64,
    /// Degrees for each unit of its output.
    pub degrees_per_output: f64,
}

impl MachineParameters {
    /// Its command under `pulse`.
    fn command(&self, pulse: PulseWidth) -> f64 {
        self.neutral_command + SERVO_SCALE.degrees(pulse).0 * self.command_per_degree
    }

    /// Where it rests under the neutral pulse (deg).
    pub fn rest_deg(&self) -> f64 {
        self.servo.resting_output(self.neutral_command) * self.degrees_per_output
    }
}

/// A servo of the equation; see the module's text.
#[derive(Clone, Debug)]
pub struct MachineServo {
    parameters: MachineParameters,
    commands: DelayLine,
    /// A step of the length [`STEP`].
    whole_step: Stepper<f64>,
    /// The command in force.
    command: f64,
    /// The state at the time `since`.
    state: State<f64>,
    since: Duration,
    /// The latest time asked for.
    latest: Duration,
}

impl MachineServo {
    /// A servo at rest under the neutral pulse, whose commands act `clock_phase` later than the delay of the equation.
    pub fn new(parameters: MachineParameters, clock_phase: Duration) -> Self {
        let servo = &parameters.servo;
        let delay = Duration::try_from_secs_f64(servo.delay_s).unwrap_or_default();
        let command = parameters.neutral_command;
        Self {
            commands: DelayLine::new(delay + clock_phase),
            whole_step: Stepper::new(servo, STEP.as_secs_f64()),
            command,
            state: State::at_rest(servo.resting_angle(command)),
            since: Duration::ZERO,
            latest: Duration::ZERO,
            parameters,
        }
    }

    /// Takes the state to the last grid point or change of the command at or before `at`.
    fn advance(&mut self, at: Duration) {
        loop {
            let grid_point = next_grid_point(self.since);
            match self.commands.pop_due(grid_point.min(at)) {
                Some((acts, pulse)) => {
                    let command = pulse.map_or(self.command, |p| self.parameters.command(p));
                    if command != self.command {
                        let acts = acts.max(self.since);
                        (self.state, self.since) = (self.state_at(acts), acts);
                        self.command = command;
                    }
                }
                None if grid_point <= at => {
                    (self.state, self.since) = (self.state_at(grid_point), grid_point);
                }
                None => break,
            }
        }
    }

    /// The state at `at`, which lies within a step, under the command in force.
    fn state_at(&self, at: Duration) -> State<f64> {
        let mut state = self.state;
        let length = at.saturating_sub(self.since);
        if length == STEP {
            self.whole_step.advance(&mut state, self.command);
        } else if length > Duration::ZERO {
            let shorter = Stepper::new(&self.parameters.servo, length.as_secs_f64());
            shorter.advance(&mut state, self.command);
        }
        state
    }
}

fn next_grid_point(since: Duration) -> Duration {
    let step = STEP.as_nanos();
    Duration::from_nanos_u128((since.as_nanos() / step + 1) * step)
}

impl Servo for MachineServo {
    fn command(&mut self, at: Duration, pulse: Option<PulseWidth>) {
        let end = self.parameters.servo.pulse_end.zip(pulse);
        let later_s = end.map_or(0.0, |(end, pulse)| {
            end.later_s(self.parameters.command(pulse))
        });
        let later = Duration::from_secs_f64(later_s.abs());
        let known = match later_s < 0.0 {
            true => at.saturating_sub(later),
            false => at + later,
        };
        self.commands.push(known, pulse);
    }

    fn angle(&mut self, at: Duration) -> f64 {
        self.latest = self.latest.max(at);
        self.advance(self.latest);
        let servo = &self.parameters.servo;
        let output = self.state_at(self.latest).output(servo);
        output * self.parameters.degrees_per_output
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linear::{LinearParameters, LinearServo};
    use servoid_dynamics::{AtRest, DriveLimit, Friction, Load, PulseEnd};

    fn ms(t: u64) -> Duration {
        Duration::from_millis(t)
    }

    fn in_degrees(servo: ServoParameters) -> MachineParameters {
        MachineParameters {
            servo,
            neutral_command: 0.0,
            command_per_degree: 1.0,
            degrees_per_output: 1.0,
        }
    }

    fn linear(p: LinearParameters) -> ServoParameters {
        ServoParameters {
            delay_s: p.delay.as_secs_f64(),
            gain: p.gain,
            ..ServoParameters::linear(
                p.natural_frequency * p.natural_frequency,
                2.0 * p.damping * p.natural_frequency,
            )
        }
    }

    /// Everything that the equation has.
    fn full() -> ServoParameters {
        ServoParameters {
            limit: Some(DriveLimit {
                up: 6000.0,
                down_to_up: 0.8,
                motor_damping: 25.0,
                at_one_stiffness: false,
            }),
            speed_limit: None,
            dead_band: Some(0.05),
            friction: Some(Friction {
                coulomb: 200.0,
                of_gears: 0.1,
                at_rest: Some(AtRest {
                    excess: 0.5,
                    speed: 2.0,
                }),
            }),
            load: Load::Pendulum {
                gravity: 900.0,
                from: 20.0,
                radians: 1f64.to_radians(),
            },
            offset: 1.5,
            ..linear(LinearParameters::default())
        }
    }

    fn commanded(servo: &mut impl Servo) {
        for (frame, us) in [1500, 1550, 1550, 1430, 1480].into_iter().enumerate() {
            servo.command(ms(20 * frame as u64), Some(PulseWidth(us)));
        }
    }

    #[test]
    fn the_motion_does_not_depend_on_when_it_is_looked_at() {
        for clock_phase in [Duration::ZERO, Duration::from_nanos(33_333)] {
            let new = || MachineServo::new(in_degrees(full()), clock_phase);
            let (mut often, mut seldom) = (new(), new());
            commanded(&mut often);
            commanded(&mut seldom);
            for us in (0..180_000).step_by(37) {
                often.angle(Duration::from_micros(us));
            }
            let at = Duration::from_nanos(180_012_345);
            assert_eq!(often.angle(at), seldom.angle(at)); // to the last bit
            assert_eq!(often.angle(ms(20)), often.angle(at), "time goes forward");
        }
    }

    #[test]
    fn a_pulse_known_at_its_end_acts_as_if_known_at_its_edge() {
        let new = || MachineServo::new(in_degrees(full()), Duration::ZERO);
        let (mut early, mut late) = (new(), new());
        early.command(ms(20), Some(PulseWidth(1550)));
        late.angle(Duration::from_micros(21_500));
        late.command(ms(20), Some(PulseWidth(1550)));
        assert_eq!(early.angle(ms(70)), late.angle(ms(70)));
    }

    #[test]
    fn a_longer_pulse_acts_later_where_pulses_are_known_at_their_ends() {
        let constant = linear(LinearParameters::default());
        let at_its_end = ServoParameters {
            pulse_end: Some(PulseEnd {
                s_per_command: -1e-5,
                neutral: 0.0,
            }),
            ..constant
        };
        // 1550 us are 5 degrees: 0.05 ms earlier.
        for (us, pulse, earlier) in [(20_000_u64, 1550, 50_i64), (20_050, 1450, -50)] {
            let mut known_early = MachineServo::new(in_degrees(at_its_end), Duration::ZERO);
            let mut other = MachineServo::new(in_degrees(constant), Duration::ZERO);
            let begins = Duration::from_micros(us);
            known_early.command(begins, Some(PulseWidth(pulse)));
            let acts = Duration::from_micros(us.saturating_add_signed(-earlier));
            other.command(acts, Some(PulseWidth(pulse)));
            let reached = [&mut known_early, &mut other].map(|servo| servo.angle(ms(70)));
            assert!(
                (reached[0] - reached[1]).abs() < 1e-9 && reached[0].abs() > 1.0,
                "{reached:?}"
            );
        }
    }

    /// Leapfrog errs by (ωh)²/24 of the phase ωt: 1.5e-6 ωt with ωh = 0.006, and the shape over the 60 ms of a transient
    /// of 12 degrees by as much. Ten times that is allowed.
    #[test]
    fn a_linear_servo_moves_as_the_formula_says() {
        for damping in [0.3, 0.7, 1.0, 2.0] {
            let parameters = LinearParameters {
                gain: 0.93,
                damping,
                delay: Duration::from_nanos(21_537_219),
                ..LinearParameters::default()
            };
            let mut exact = LinearServo::new(parameters);
            let mut servo = MachineServo::new(in_degrees(linear(parameters)), Duration::ZERO);
            commanded(&mut exact);
            commanded(&mut servo);
            for us in (0..300_000).step_by(613) {
                let at = Duration::from_micros(us);
                let error = servo.angle(at) - exact.angle(at);
                assert!(error.abs() < 1e-3, "{damping} at {at:?}: {error}");
            }
        }
    }

    #[test]
    fn units_of_its_own_give_the_same_motion() {
        // Command in pulse widths of which 1500 are the middle, output in radians.
        let radian = 1f64.to_radians();
        let degrees = linear(LinearParameters::default());
        let mut other = degrees;
        (other.gain, other.offset) = (radian / 10.0, -150.0 * radian);
        let mut plain = MachineServo::new(in_degrees(degrees), Duration::ZERO);
        let parameters = MachineParameters {
            servo: other,
            neutral_command: 1500.0,
            command_per_degree: 10.0,
            degrees_per_output: radian.recip(),
        };
        assert!(parameters.rest_deg().abs() < 1e-9);
        let mut other = MachineServo::new(parameters, Duration::ZERO);
        commanded(&mut plain);
        commanded(&mut other);
        for at in (0..200).map(ms) {
            // Rounding of numbers near 1500.
            assert!((plain.angle(at) - other.angle(at)).abs() < 1e-9);
        }
    }

    #[test]
    fn it_stays_where_its_load_leaves_it_until_a_pulse_comes() {
        let parameters = in_degrees(full());
        let mut servo = MachineServo::new(parameters, Duration::ZERO);
        let rest = parameters.rest_deg();
        assert!(rest < 1.5, "the weight pulls it down: {rest}");
        assert!((servo.angle(ms(1000)) - rest).abs() < 1e-12);
    }
}
