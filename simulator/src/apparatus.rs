//! Servo, sensor and ADC together: a pulse in, a frame of samples out.

use crate::noise::Noise;
use crate::options::{OptionsError, SimulationOptions};
use crate::parts::Parts;
use crate::sensor::{HallSensor, OVERSAMPLING, SENSOR_SCALE, sum};
use crate::servo::Servo;
use servoid_protocol::timing::{FRAME_US, SAMPLE_US, SAMPLES_PER_FRAME};
use servoid_protocol::{Counts, PulseWidth};
use std::time::Duration;

/// Length of a PWM frame.
pub(crate) const FRAME: Duration = Duration::from_micros(FRAME_US as u64);

/// One PWM frame, with the true angles behind its samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SimulatedFrame {
    /// Frames since the start of the simulation.
    pub number: u64,
    /// The pulse in this frame.
    pub pulse: Option<PulseWidth>,
    /// The counts of the ADC.
    pub samples: [Counts; SAMPLES_PER_FRAME],
    /// The true angles at the samples' times, without noise and rounding (deg).
    pub angles: [f64; SAMPLES_PER_FRAME],
}

impl SimulatedFrame {
    /// The measured angles (deg), by the nominal [`SENSOR_SCALE`].
    #[must_use]
    pub fn degrees(&self) -> [f64; SAMPLES_PER_FRAME] {
        self.samples.map(|counts| SENSOR_SCALE.degrees(counts).0)
    }
}

/// One sample, with the true angle behind it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// The true angle (deg).
    pub angle: f64,
    /// The code of each conversion of the ADC; the board [sums](sum) them.
    pub conversions: [u16; OVERSAMPLING],
}

/// Servo and sensor, as a board's wires would connect them.
///
/// [`frame`](Self::frame) keeps the rig's timing. With [`command`](Self::command) and [`sample`](Self::sample) a caller
/// keeps its own, forward in time only.
pub struct Apparatus {
    servo: Box<dyn Servo + Send>,
    sensor: HallSensor,
    noise: Noise,
    first_sample: Duration,
    number: u64,
}

impl Apparatus {
    /// An apparatus at rest, before its first frame.
    ///
    /// # Errors
    /// [`OptionsError`] where an option has an invalid value.
    pub fn new(options: &SimulationOptions) -> Result<Self, OptionsError> {
        let Parts {
            servo,
            sensor,
            noise,
        } = Parts::new(options)?;
        Ok(Self {
            servo,
            sensor,
            noise,
            first_sample: Duration::from_micros(options.first_sample_us.into()),
            number: 0,
        })
    }

    /// A pulse at `at`; see [`Servo::command`].
    pub fn command(&mut self, at: Duration, pulse: Option<PulseWidth>) {
        self.servo.command(at, pulse);
    }

    /// The next sample, at `at`. All its conversions see the same angle.
    pub fn sample(&mut self, at: Duration) -> Sample {
        let angle = self.servo.angle(at);
        let conversions = self.sensor.convert(at, angle, &self.noise.next_sample());
        Sample { angle, conversions }
    }

    /// The next PWM frame, with `pulse` at its edge. Sample `j` is taken `first_sample_us + j · 2 ms`
    /// after the edge.
    pub fn frame(&mut self, pulse: Option<PulseWidth>) -> SimulatedFrame {
        let number = self.number;
        self.number += 1;
        let edge = Duration::from_micros(number * u64::from(FRAME_US));
        self.command(edge, pulse);
        let samples: [Sample; SAMPLES_PER_FRAME] = std::array::from_fn(|j| {
            let since_first = Duration::from_micros(j as u64 * u64::from(SAMPLE_US));
            self.sample(edge + self.first_sample + since_first)
        });
        SimulatedFrame {
            number,
            pulse,
            samples: samples.map(|sample| sum(sample.conversions)),
            angles: samples.map(|sample| sample.angle),
        }
    }
}
