//! The sampling capacitor of the ADC, which every channel charges from what the last one left in it.

use crate::time::{TICKS_PER_SECOND, Ticks};

/// The capacitor, and the switch before it (DS5319, table of ADC characteristics: largest values).
const FARADS: f64 = 8e-12;
const SWITCH_OHMS: f64 = 1_000.0;

/// The only channel with a resistance of its own outside the chip; the others are within it.
const SENSOR: u32 = 4;

#[derive(Debug)]
pub(super) struct SamplingCapacitor {
    source_ohms: f64,
    /// Its voltage (codes).
    charge: f64,
}

impl SamplingCapacitor {
    pub(super) fn new(source_ohms: f64) -> Self {
        Self {
            source_ohms,
            charge: 0.0,
        }
    }

    /// The code of `input` after it was sampled for `time`.
    pub(super) fn sample(&mut self, channel: u32, input: u16, time: Ticks) -> u16 {
        let source = if channel == SENSOR {
            self.source_ohms
        } else {
            0.0
        };
        let constants = time as f64 / TICKS_PER_SECOND as f64 / ((source + SWITCH_OHMS) * FARADS);
        let input = f64::from(input);
        self.charge = input + (self.charge - input) * (-constants).exp();
        self.charge.round() as u16
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::time::microseconds;

    /// After a time constant, 36.8 % of the difference are left: 1 MΩ and 8 pF are 8 µs.
    #[test]
    fn a_high_impedance_takes_its_time() {
        let mut capacitor = SamplingCapacitor::new(1e6 - SWITCH_OHMS);
        assert_eq!(capacitor.sample(SENSOR, 4_000, microseconds(8)), 2_528);
        assert_eq!(capacitor.sample(17, 1_500, microseconds(8)), 1_500);
        assert_eq!(capacitor.sample(SENSOR, 1_500, microseconds(8)), 1_500);
    }
}
