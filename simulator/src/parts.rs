//! The parts of every simulated rig: servo, sensor and noise.

use crate::noise::Noise;
use crate::options::{OptionsError, ServoKind, SimulationOptions};
use crate::sensor::HallSensor;
use crate::servo::Servo;
use crate::{aircraft, bench, linear};

/// Servo, sensor and noise of one simulation, at rest.
pub struct Parts {
    /// The servo, under the run's conditions.
    pub servo: Box<dyn Servo + Send>,
    /// The sensor on its shaft.
    pub sensor: HallSensor,
    /// The noise of the measured angle.
    pub noise: Noise,
}

impl Parts {
    /// The parts that `options` describe.
    ///
    /// # Errors
    /// [`OptionsError`] where an option has an invalid value.
    pub fn new(options: &SimulationOptions) -> Result<Self, OptionsError> {
        options.check()?;
        let conditions = options.conditions.scattered(options.scatter, options.seed);
        let servo: Box<dyn Servo + Send> = match options.servo {
            ServoKind::Bench => Box::new(bench::servo(&conditions)),
            ServoKind::Aircraft => Box::new(aircraft::servo(&conditions)),
            ServoKind::Linear(mut parameters) => {
                parameters.delay += conditions.clock_phase;
                Box::new(linear::LinearServo::new(parameters))
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
        })
    }
}
