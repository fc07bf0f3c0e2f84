//! The servo and its sensor, on the wires of the board.

use crate::record::Pulse;
use crate::time::{TICKS_PER_MICROSECOND, Ticks, milliseconds, to_duration};
use servoid_protocol::PulseWidth;
use servoid_simulator::sensor::{OVERSAMPLING, SampleNoise};
use servoid_simulator::{OptionsError, Parts, SimulationOptions};

/// Longest period of the pulses that a servo expects.
const FRAME: Ticks = milliseconds(20);
/// A pulse later than this counts as missing. Less than the latency of a servo, so the servo gets this in time.
const PATIENCE: Ticks = milliseconds(10);

/// Servo, sensor and divider, with the voltage at PA4 as codes of the ADC.
///
/// Unlike on the in-process rig, each conversion reads the angle at the instant at which the ADC holds its input.
#[derive(Debug)]
pub struct Plant {
    parts: Parts,
    sample: SampleNoise,
    last_rise: Option<Ticks>,
}

impl Plant {
    /// Servo and sensor at rest.
    pub fn new(options: &SimulationOptions) -> Result<Self, OptionsError> {
        Ok(Self {
            parts: Parts::new(options)?,
            sample: SampleNoise::default(),
            last_rise: None,
        })
    }

    /// A pulse has ended. The servo measures it in whole microseconds, as with its own timer.
    pub fn pulse(&mut self, pulse: Pulse) {
        let width = (pulse.width + TICKS_PER_MICROSECOND / 2) / TICKS_PER_MICROSECOND;
        let width = u16::try_from(width).unwrap_or(u16::MAX);
        let at = to_duration(pulse.rise);
        self.parts.command(at, Some(PulseWidth(width)));
        self.last_rise = Some(pulse.rise);
    }

    /// The code of the input at `held`, the instant at which it was held, for conversion `index` of
    /// a sample.
    pub fn code(&mut self, held: Ticks, index: u32) -> u16 {
        let is_missing = |rise: &mut Ticks| held > *rise + FRAME + PATIENCE;
        let parts = &mut self.parts;
        if let Some(rise) = self.last_rise.take_if(is_missing) {
            parts.command(to_duration(rise + FRAME), None);
        }
        if index == 0 {
            self.sample = parts.noise.next_sample();
        }
        let at = to_duration(held);
        let angle = parts.servo.angle(at);
        parts.sensor.convert(at, angle, &self.sample)[index as usize % OVERSAMPLING]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::time::microseconds;
    use servoid_simulator::SENSOR_SCALE;
    use servoid_simulator::sensor::sum;

    fn degrees(plant: &mut Plant, at: Ticks) -> f64 {
        let codes = std::array::from_fn(|k| plant.code(at + microseconds(21) * k as u64, k as u32));
        SENSOR_SCALE.degrees(sum(codes)).0
    }

    #[test]
    fn the_servo_follows_measured_pulses() {
        let options = "linear?noise=none".parse().unwrap();
        let mut plant = Plant::new(&options).unwrap();
        assert_eq!(degrees(&mut plant, milliseconds(1)), 0.0);
        for frame in 0..50 {
            plant.pulse(Pulse {
                rise: FRAME * frame,
                width: microseconds(1_550),
            });
        }
        // Within half a step of the sum of four conversions that all round alike.
        let step = 4.0 * SENSOR_SCALE.degrees_per_count;
        assert!((degrees(&mut plant, milliseconds(1_000)) - 5.0).abs() <= step / 2.0);
    }

    /// Angle of a bench servo after 0.3 s, of which this many pulses commanded 40 degrees.
    fn angle_after(pulses: u64) -> f64 {
        let options = "bench?noise=none".parse().unwrap();
        let mut plant = Plant::new(&options).unwrap();
        let mut angle = 0.0;
        for frame in 0..15 {
            if frame < pulses {
                plant.pulse(Pulse {
                    rise: FRAME * frame,
                    width: microseconds(1_900),
                });
            }
            angle = degrees(&mut plant, FRAME * (frame + 1));
        }
        angle
    }

    #[test]
    fn pulses_that_end_leave_a_motor_without_command() {
        assert!((angle_after(15) - 40.0).abs() < 3.0, "{}", angle_after(15));
        // On its way when the pulses end, and nothing stops it at 40 degrees.
        assert!((angle_after(2) - 40.0).abs() > 10.0, "{}", angle_after(2));
    }
}
