//! Servo, sensor and ADC together: a pulse in, a frame of samples out.

use crate::options::{OptionsError, SimulationOptions};
use crate::parts::Parts;
use crate::sensor::{SENSOR_SCALE, sum};
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
    pub fn degrees(&self) -> [f64; SAMPLES_PER_FRAME] {
        self.samples.map(|counts| SENSOR_SCALE.degrees(counts).0)
    }
}

/// Servo and sensor on the wires of a rig, which keeps the rig's timing.
pub struct Apparatus {
    parts: Parts,
    first_sample: Duration,
    number: u64,
}

impl Apparatus {
    /// An apparatus at rest, before its first frame.
    pub fn new(options: &SimulationOptions) -> Result<Self, OptionsError> {
        Ok(Self {
            parts: Parts::new(options)?,
            first_sample: Duration::from_micros(options.first_sample_us.into()),
            number: 0,
        })
    }

    /// The next PWM frame, with `pulse` at its edge. Sample `j` is taken `first_sample_us + j · 2 ms`
    /// after the edge; all its conversions see the same angle.
    pub fn frame(&mut self, pulse: Option<PulseWidth>) -> SimulatedFrame {
        let mut frame = SimulatedFrame {
            number: self.number,
            pulse,
            samples: Default::default(),
            angles: Default::default(),
        };
        self.number += 1;
        let edge = Duration::from_micros(frame.number * u64::from(FRAME_US));
        let parts = &mut self.parts;
        parts.servo.command(edge, pulse);
        for (j, (counts, angle)) in (0..).zip(frame.samples.iter_mut().zip(&mut frame.angles)) {
            let at = edge + self.first_sample + Duration::from_micros(j * u64::from(SAMPLE_US));
            *angle = parts.servo.angle(at);
            *counts = sum(parts.sensor.convert(at, *angle, &parts.noise.next_sample()));
        }
        frame
    }
}
