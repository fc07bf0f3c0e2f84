//! Differences between two runs of the same servo.
//!
//! Between two runs the supply differs by a percent and the friction by a fifth, the control loop runs at another
//! phase to the pulses, and the propeller starts at another angle. A comparison that ignores this reports equal
//! servos as different.

use crate::motor::MotorParameters;
use crate::random::{Stream, stream};
use rand::{Rng, RngExt};
use rand_distr::StandardNormal;
use std::f64::consts::TAU;
use std::time::Duration;

/// Standard deviation of the supply between runs, relative.
const SUPPLY_SD: f64 = 0.01;
/// Standard deviation of the friction between runs, relative.
const FRICTION_SD: f64 = 0.20;
/// Standard deviation of the sensor's gain between runs, relative.
const SENSOR_GAIN_SD: f64 = 0.001;
/// Period of the servo's own loop (s): its phase to the pulses is uniform over it.
const LOOP_PERIOD: f64 = 0.002;

/// The conditions of one run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conditions {
    /// Supply, relative to nominal: scales stall torque and no-load speed. Above 0.
    pub supply: f64,
    /// Coulomb friction, relative to nominal. 0 or above.
    pub friction: f64,
    /// Gain of the angle sensor, relative to nominal. Above 0. The calibration that a rig is given
    /// is the nominal one.
    pub sensor_gain: f64,
    /// Angle at which the sensor reads the calibration's counts for 0 degrees (deg).
    pub sensor_zero: f64,
    /// The angles at which the shaft meets its stops (deg), the lower one first, below and above 0; `None`
    /// where it meets none.
    pub stops: Option<(f64, f64)>,
    /// Full width of the play between gears and output (deg), 0 or above; `None` for the servo's own.
    pub play: Option<f64>,
    /// Latency that the phase of the servo's clock adds.
    pub clock_phase: Duration,
    /// Angle of the propeller at time 0 (rad).
    pub rotor_phase: f64,
}

impl Default for Conditions {
    /// Nominal.
    fn default() -> Self {
        Self {
            supply: 1.0,
            friction: 1.0,
            sensor_gain: 1.0,
            sensor_zero: 0.0,
            stops: None,
            play: None,
            clock_phase: Duration::ZERO,
            rotor_phase: 0.0,
        }
    }
}

impl Conditions {
    /// `motor` under these conditions.
    pub fn applied_to(&self, motor: MotorParameters) -> MotorParameters {
        MotorParameters {
            stall_torque: motor.stall_torque * self.supply,
            no_load_speed: motor.no_load_speed * self.supply,
            friction: motor.friction * self.friction,
            latency: motor.latency + self.clock_phase,
            stops: self.stops.or(motor.stops),
            play: self.play.unwrap_or(motor.play),
            ..motor
        }
    }

    /// The conditions of the run of `seed`: each part that `scatter` names is drawn around its value here.
    /// Supply, friction and the sensor's gain are normal; the phases are uniform over their period.
    pub fn scattered(mut self, scatter: Scatter, seed: u64) -> Self {
        let mut random = stream(seed, Stream::Scatter);
        // All parts are drawn in any case, so the value of one does not depend on the choice of others.
        let clock = random.random_range(0.0..LOOP_PERIOD);
        let rotor = random.random_range(0.0..TAU);
        let supply = factor(&mut random, SUPPLY_SD);
        let friction = factor(&mut random, FRICTION_SD);
        let sensor = factor(&mut random, SENSOR_GAIN_SD);
        let phase = |is_drawn: bool, drawn: f64| if is_drawn { drawn } else { 0.0 };
        let gain = |is_drawn: bool, drawn: f64| if is_drawn { drawn } else { 1.0 };
        self.clock_phase += Duration::from_secs_f64(phase(scatter.clock, clock));
        self.rotor_phase += phase(scatter.rotor, rotor);
        self.supply *= gain(scatter.supply, supply);
        self.friction *= gain(scatter.friction, friction);
        self.sensor_gain *= gain(scatter.sensor, sensor);
        self
    }
}

/// A factor around 1; friction at five standard deviations would be negative, hence the limit.
fn factor(random: &mut impl Rng, sd: f64) -> f64 {
    (1.0 + sd * random.sample::<f64, _>(StandardNormal)).max(0.0)
}

/// Which conditions differ from run to run; see [`Conditions::scattered`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Scatter {
    /// The phase of the servo's own clock.
    pub clock: bool,
    /// The supply.
    pub supply: bool,
    /// The friction.
    pub friction: bool,
    /// The sensor's gain.
    pub sensor: bool,
    /// The propeller's angle at the start.
    pub rotor: bool,
}

impl Scatter {
    /// All parts, as on a real rig.
    pub const ALL: Self = Self {
        clock: true,
        supply: true,
        friction: true,
        sensor: true,
        rotor: true,
    };
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::BENCH;

    #[test]
    fn supply_scales_torque_and_speed_and_the_clock_delays() {
        let conditions = Conditions {
            supply: 0.5,
            friction: 2.0,
            clock_phase: Duration::from_millis(1),
            ..Conditions::default()
        };
        let expected = MotorParameters {
            stall_torque: 0.59,
            no_load_speed: 6.55,
            friction: 0.024,
            latency: Duration::from_micros(22_500),
            ..BENCH
        };
        assert_eq!(conditions.applied_to(BENCH), expected); // halves and doubles are exact
    }

    #[test]
    fn one_part_does_not_depend_on_the_others() {
        let all = Conditions::default().scattered(Scatter::ALL, 7);
        let only = Scatter {
            friction: true,
            ..Scatter::default()
        };
        let friction = Conditions::default().scattered(only, 7);
        assert_eq!(
            friction,
            Conditions {
                friction: all.friction,
                ..Conditions::default()
            }
        );
        assert_ne!(friction.friction, 1.0);
    }

    /// Mean and standard deviation over 4000 seeds. The mean of n draws scatters by sd/√n and the
    /// standard deviation by sd/√(2n) (normal; less for uniform); four of those are allowed, which
    /// a correct program passes at these fixed seeds and one off by 10 % does not.
    #[test]
    fn the_scatter_is_as_wide_as_said() {
        const N: u64 = 4000;
        let drawn: Vec<Conditions> = (0..N)
            .map(|seed| Conditions::default().scattered(Scatter::ALL, seed))
            .collect();
        let uniform_sd = |width: f64| width / 12f64.sqrt();
        for (name, mean, sd, value) in [
            (
                "supply",
                1.0,
                0.01,
                (|c| c.supply) as fn(&Conditions) -> f64,
            ),
            ("friction", 1.0, 0.2, |c| c.friction),
            ("sensor", 1.0, 0.001, |c| c.sensor_gain),
            ("clock", 1e-3, uniform_sd(2e-3), |c| {
                c.clock_phase.as_secs_f64()
            }),
            ("rotor", TAU / 2.0, uniform_sd(TAU), |c| c.rotor_phase),
        ] {
            let n = N as f64;
            let found = drawn.iter().map(value).sum::<f64>() / n;
            let variance = drawn
                .iter()
                .map(|c| (value(c) - found).powi(2))
                .sum::<f64>()
                / n;
            assert!(
                (found - mean).abs() < 4.0 * sd / n.sqrt(),
                "{name}: {found}"
            );
            let error = variance.sqrt() - sd;
            assert!(error.abs() < 4.0 * sd / (2.0 * n).sqrt(), "{name}: {error}");
        }
    }
}
