//! Servo, sensor and ADC together: a pulse in, a frame of samples out.

use crate::options::{OptionsError, SimulationOptions, first_sample_us};
use crate::parts::Parts;
use crate::sensor::{SENSOR_SCALE, sum};
use servoid_protocol::timing::SAMPLES_PER_FRAME;
use servoid_protocol::{Counts, PulseTrain, PulseWidth};
use std::time::Duration;

/// One frame, with the true angles behind its samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SimulatedFrame {
    /// Frames since the start of the simulation.
    pub number: u64,
    /// The train whose frame this is.
    pub train: PulseTrain,
    /// The pulses in this frame.
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
    /// With the usual train (µs).
    first_sample_us: u16,
    number: u64,
    /// When the next frame begins.
    edge: Duration,
}

impl Apparatus {
    /// An apparatus at rest, before its first frame.
    pub fn new(options: &SimulationOptions) -> Result<Self, OptionsError> {
        Ok(Self {
            parts: Parts::new(options)?,
            first_sample_us: options.first_sample_us,
            number: 0,
            edge: Duration::ZERO,
        })
    }

    /// The next frame, with equal pulses of this train. Sample `j` is taken `j` sample periods after the first one; all its
    /// conversions see the same angle.
    pub fn frame_of(&mut self, train: PulseTrain, pulse: Option<PulseWidth>) -> SimulatedFrame {
        let mut frame = SimulatedFrame {
            number: self.number,
            train,
            pulse,
            samples: Default::default(),
            angles: Default::default(),
        };
        self.number += 1;
        let edge = self.edge;
        self.edge += Duration::from_micros(train.frame_us().into());
        let first_us = u64::from(first_sample_us(self.first_sample_us, train));
        let parts = &mut self.parts;
        let (sample_us, per_pulse) = (u64::from(train.sample_us()), train.samples_per_pulse());
        for (j, (counts, angle)) in (0..).zip(frame.samples.iter_mut().zip(&mut frame.angles)) {
            if j % u64::from(per_pulse) == 0 {
                parts.command(edge + Duration::from_micros(j * sample_us), pulse);
            }
            let at = edge + Duration::from_micros(first_us + j * sample_us);
            *angle = parts.servo.angle(at);
            *counts = sum(parts.sensor.convert(at, *angle, &parts.noise.next_sample()));
        }
        frame
    }
}
