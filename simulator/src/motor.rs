//! A digital position servo: a geared DC motor in a PD loop.
//!
//! θ (rad) is the angle of the output shaft, ω (rad/s) its speed, r (rad) the commanded angle:
//!
//! ```text
//!  r      the newest pulse that is at least `latency` old
//!  e      = r - θ, but 0 where |e| < dead band
//!  ωf'    = (ω - ωf) / Tf                        the loop's filtered speed
//!  duty   = Kp e - Kd ωf, limited to ±1          of the supply
//!  J ω'   = τs (duty - ω/ω0) - τc tanh(ω/ωs) - τload
//!  θ'     = ω
//!  output = play(θ)
//! ```
//!
//! A stop takes all speed: θ stays there until the torque turns round.
//!
//! τs is the stall torque, ω0 the no-load speed; τc tanh(ω/ωs) is Coulomb friction, smoothed below
//! ωs. Both τs and ω0 are proportional to the supply. The play lies between the gear train, where
//! the loop measures, and the output, where the sensor sits.
//!
//! Integrated by semi-implicit Euler (speed first, then angle) on a fixed grid of [`GRID`]; between
//! grid points θ is linear, as in the scheme itself. A pulse takes effect at the first grid
//! point that is not before its time.
//!
//! Without pulses the motor is off: no torque, no braking, the shaft coasts and follows the load.
//! That is what most analogue servos do, and the worst case for an aircraft.

use crate::delay_line::DelayLine;
use crate::load::AerodynamicLoad;
use crate::servo::{SERVO_SCALE, Servo};
use servoid_protocol::PulseWidth;
use std::time::Duration;

/// Step of the integration.
pub const GRID: Duration = Duration::from_micros(100);

/// The parameters of a motor servo.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotorParameters {
    /// Stall torque τs (N m).
    pub stall_torque: f64,
    /// No-load speed ω0 (rad/s).
    pub no_load_speed: f64,
    /// Inertia J of all that turns, at the output shaft (kg m²).
    pub inertia: f64,
    /// Proportional gain Kp (1/rad).
    pub proportional_gain: f64,
    /// Speed gain Kd (s/rad).
    pub speed_gain: f64,
    /// Time constant Tf of the speed filter (s); longer than [`GRID`].
    pub speed_filter: f64,
    /// Coulomb friction τc (N m).
    pub friction: f64,
    /// Speed ωs below which the friction fades (rad/s).
    pub friction_speed: f64,
    /// Half width of the dead band (deg).
    pub dead_band: f64,
    /// Full width of the play (deg).
    pub play: f64,
    /// Time from a pulse's rising edge to its effect on the loop.
    pub latency: Duration,
    /// The angles at which θ meets its stops (deg), the lower one first; `None` where it meets none.
    pub stops: Option<(f64, f64)>,
}

/// The state of the servo.
#[derive(Clone, Copy, Debug)]
struct State {
    /// θ (rad).
    angle: f64,
    /// ω (rad/s).
    speed: f64,
    /// ωf (rad/s).
    filtered_speed: f64,
    /// play(θ) (rad).
    output: f64,
}

/// A motor servo, free or loaded; see the module's text.
#[derive(Clone, Debug)]
pub struct MotorServo {
    parameters: MotorParameters,
    load: Option<AerodynamicLoad>,
    commands: DelayLine,
    /// r (rad); `None` while the motor is off.
    target: Option<f64>,
    state: State,
    /// Grid point of `state`.
    step: u64,
}

impl MotorServo {
    /// A servo at rest at 0 degrees, without pulses.
    pub fn new(parameters: MotorParameters, load: Option<AerodynamicLoad>) -> Self {
        Self {
            commands: DelayLine::new(parameters.latency),
            parameters,
            load,
            target: None,
            state: State {
                angle: 0.0,
                speed: 0.0,
                filtered_speed: 0.0,
                output: 0.0,
            },
            step: 0,
        }
    }

    /// Commands that have come into force by the present grid point.
    fn take_commands(&mut self) {
        while let Some((_, pulse)) = self.commands.pop_due(grid_time(self.step)) {
            self.target = pulse.map(|p| SERVO_SCALE.degrees(p).0.to_radians());
        }
    }

    /// Torque of the motor (N m); `filtered_speed` is ωf at the same instant.
    fn motor_torque(&self, filtered_speed: f64) -> f64 {
        let (p, s) = (&self.parameters, &self.state);
        let Some(target) = self.target else {
            return 0.0;
        };
        let error = target - s.angle;
        let error = if error.abs() < p.dead_band.to_radians() {
            0.0
        } else {
            error
        };
        let duty = p.proportional_gain * error - p.speed_gain * filtered_speed;
        p.stall_torque * (duty.clamp(-1.0, 1.0) - s.speed / p.no_load_speed)
    }

    /// The state one grid point on.
    fn next(&self) -> State {
        let (p, s) = (&self.parameters, &self.state);
        let dt = GRID.as_secs_f64();
        let filtered_speed = s.filtered_speed + dt / p.speed_filter * (s.speed - s.filtered_speed);
        let friction = p.friction * (s.speed / p.friction_speed).tanh();
        let load = self.load.map_or(0.0, |load| {
            load.torque(grid_time(self.step).as_secs_f64(), s.angle, s.speed)
        });
        let torque = self.motor_torque(filtered_speed) - friction - load;
        let speed = s.speed + dt * torque / p.inertia;
        let (angle, speed) = self.stopped(s.angle + dt * speed, speed);
        State {
            angle,
            speed,
            filtered_speed,
            output: self.after_play(angle),
        }
    }

    /// Angle (rad) and speed, limited by the stops.
    fn stopped(&self, angle: f64, speed: f64) -> (f64, f64) {
        let Some((low, high)) = self.parameters.stops else {
            return (angle, speed);
        };
        let held = angle.clamp(low.to_radians(), high.to_radians());
        (held, if held == angle { speed } else { 0.0 })
    }

    /// The output once the shaft before the play has come to `angle` (rad).
    fn after_play(&self, angle: f64) -> f64 {
        let half = self.parameters.play.to_radians() / 2.0;
        self.state.output.clamp(angle - half, angle + half)
    }
}

fn grid_time(step: u64) -> Duration {
    Duration::from_nanos(step * GRID.as_nanos() as u64)
}

impl Servo for MotorServo {
    fn command(&mut self, at: Duration, pulse: Option<PulseWidth>) {
        self.commands.push(at, pulse);
    }

    fn angle(&mut self, at: Duration) -> f64 {
        self.take_commands();
        while grid_time(self.step + 1) <= at {
            self.state = self.next();
            self.step += 1;
            self.take_commands();
        }
        let since = at.saturating_sub(grid_time(self.step)).as_secs_f64();
        let output = if since > 0.0 {
            self.after_play(self.state.angle + since * self.next().speed)
        } else {
            self.state.output
        };
        output.to_degrees()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::BENCH;

    fn ms(t: u64) -> Duration {
        Duration::from_millis(t)
    }

    #[test]
    fn the_motion_does_not_depend_on_when_it_is_looked_at() {
        let (mut often, mut seldom) = (MotorServo::new(BENCH, None), MotorServo::new(BENCH, None));
        for servo in [&mut often, &mut seldom] {
            servo.command(ms(0), Some(PulseWidth(1550)));
        }
        for us in (0..80_000).step_by(37) {
            often.angle(Duration::from_micros(us));
        }
        let at = Duration::from_nanos(80_012_345);
        assert_eq!(often.angle(at), seldom.angle(at)); // to the last bit
    }

    #[test]
    fn a_pulse_known_at_its_end_acts_as_if_known_at_its_edge() {
        let (mut early, mut late) = (MotorServo::new(BENCH, None), MotorServo::new(BENCH, None));
        early.command(ms(20), Some(PulseWidth(1550)));
        late.angle(Duration::from_micros(21_500));
        late.command(ms(20), Some(PulseWidth(1550)));
        assert_eq!(early.angle(ms(70)), late.angle(ms(70)));
    }

    #[test]
    fn nothing_moves_before_the_latency_is_over() {
        let mut servo = MotorServo::new(BENCH, None);
        servo.command(ms(0), Some(PulseWidth(1550)));
        assert_eq!(servo.angle(BENCH.latency), 0.0);
        assert!(servo.angle(BENCH.latency + ms(5)) > 0.0);
    }

    #[test]
    fn without_pulses_the_motor_is_off_and_the_shaft_stays_where_friction_leaves_it() {
        let mut servo = MotorServo::new(BENCH, None);
        servo.command(ms(0), Some(PulseWidth(1550)));
        let reached = servo.angle(ms(1000));
        servo.command(ms(1000), None);
        let left = servo.angle(ms(5000));
        assert!((left - reached).abs() < 0.01, "{reached} then {left}");
    }

    #[test]
    fn a_stop_holds_the_shaft_and_lets_it_go_again() {
        let parameters = MotorParameters {
            stops: Some((-4.0, 3.0)),
            ..BENCH
        };
        let mut servo = MotorServo::new(parameters, None);
        let half_play = BENCH.play / 2.0;
        for (second, us, rest) in [(0, 1550, 3.0), (1, 1400, -4.0), (2, 1500, 0.0)] {
            servo.command(ms(1000 * second), Some(PulseWidth(us)));
            let angle = servo.angle(ms(1000 * second + 900));
            // Play and dead band at most.
            assert!(
                (angle - rest).abs() <= half_play + BENCH.dead_band + 1e-9,
                "{angle}"
            );
        }
    }

    #[test]
    fn the_output_lags_by_half_the_play() {
        let mut servo = MotorServo::new(BENCH, None);
        servo.state.angle = 1f64.to_radians();
        servo.state.output = servo.after_play(1f64.to_radians());
        let up = servo.state.output.to_degrees();
        let down = servo.after_play(0.5f64.to_radians()).to_degrees();
        // Exact but for the conversion between degrees and radians.
        assert!((up - (1.0 - BENCH.play / 2.0)).abs() < 1e-12);
        assert!((down - (0.5 + BENCH.play / 2.0)).abs() < 1e-12);
    }
}
