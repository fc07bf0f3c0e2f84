//! The parts of every simulated rig: servo, sensor and noise.

use crate::aircraft::{AIRCRAFT, LOAD};
use crate::bench::BENCH;
use crate::identified_servo::MachineServo;
use crate::linear::LinearServo;
use crate::load::AerodynamicLoad;
use crate::motor::MotorServo;
use crate::noise::Noise;
use crate::options::{OptionsError, ServoKind, SimulationOptions};
use crate::sensor::HallSensor;
use crate::servo::Servo;
use servoid_protocol::PulseWidth;
use servoid_protocol::pulse_train::PulseType;
use std::time::Duration;

/// Servo, sensor and noise of one simulation, at rest.
#[derive(Debug)]
pub struct Parts {
    /// The servo, under the run's conditions.
    pub servo: Box<dyn Servo>,
    /// The sensor on its shaft.
    pub sensor: HallSensor,
    /// The noise of the measured angle.
    pub noise: Noise,
    /// The pulses that the servo understands.
    pulses: PulseType,
}

impl Parts {
    /// The parts that `options` describe.
    pub fn new(options: &SimulationOptions) -> Result<Self, OptionsError> {
        options.check()?;
        let conditions = options.conditions.scattered(options.scatter, options.seed);
        let servo: Box<dyn Servo> = match options.servo {
            ServoKind::Bench => Box::new(MotorServo::new(conditions.applied_to(BENCH), None)),
            ServoKind::Aircraft => {
                let load = AerodynamicLoad {
                    rotor_phase: conditions.rotor_phase,
                    ..LOAD
                };
                Box::new(MotorServo::new(conditions.applied_to(AIRCRAFT), Some(load)))
            }
            ServoKind::Linear(mut parameters) => {
                parameters.delay += conditions.clock_phase;
                Box::new(LinearServo::new(parameters))
            }
            ServoKind::Machine(parameters) => {
                Box::new(MachineServo::new(parameters, conditions.clock_phase))
            }
        };
        Ok(Self {
            servo,
            sensor: HallSensor::new(
                conditions.sensor_gain,
                conditions.sensor_zero,
                options.faults.clone(),
            ),
            noise: Noise::new(options.noise, options.seed),
            pulses: options.pulses,
        })
    }

    /// A pulse on the servo's wire with its rising edge at `at`, or `None` for a missing one; see [`Servo::command`]. A
    /// narrow-pulse servo takes every width for one twice as wide.
    pub fn command(&mut self, at: Duration, pulse: Option<PulseWidth>) {
        let as_wide = |PulseWidth(width)| match self.pulses {
            PulseType::Wide => PulseWidth(width),
            PulseType::Narrow => PulseWidth(width.saturating_mul(2)),
        };
        self.servo.command(at, pulse.map(as_wide));
    }
}
