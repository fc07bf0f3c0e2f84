//! Power control (RM0008 5.4): the voltage detector.

use super::{Moment, bit, field};

/// Programmable voltage detector on.
const PVDE: u32 = 4;
/// Threshold of the detector for each value of PLS, with the supply falling (mV; DS5319, table of embedded reset and
/// power control block characteristics, typical values).
const THRESHOLDS: [u64; 8] = [2_080, 2_180, 2_280, 2_380, 2_480, 2_580, 2_680, 2_780];

#[derive(Debug, Default)]
pub struct Pwr {
    cr: u32,
}

impl Pwr {
    /// Threshold of the detector (mV), if it is on.
    pub fn threshold(&self) -> Option<u64> {
        bit(self.cr, PVDE).then(|| THRESHOLDS[field(self.cr, 5, 3) as usize])
    }

    /// Reads the register at `offset` with a supply of `millivolts`.
    pub fn read(&self, offset: u32, millivolts: u64) -> Option<u32> {
        match offset {
            0x00 => Some(self.cr),
            // PVDO (5.4.2).
            0x04 => {
                let low = self.threshold().is_some_and(|limit| millivolts < limit);
                Some(u32::from(low) << 2)
            }
            _ => None,
        }
    }

    pub fn write(&mut self, offset: u32, value: u32, m: &mut Moment<'_>) -> Option<()> {
        match offset {
            0x00 => {
                let other = value & !(1 << PVDE | 7 << 5) != 0;
                m.not_modelled(other, "low-power modes and the backup domain");
                self.cr = value & (1 << PVDE | 7 << 5);
            }
            0x04 => m.not_modelled(value != 0, "the wake-up pin"),
            _ => return None,
        }
        Some(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::peripherals::testing::Bench;

    #[test]
    fn the_detector_sees_a_low_supply_when_it_is_on() {
        let (mut pwr, mut bench) = (Pwr::default(), Bench::default());
        assert_eq!(pwr.read(0x04, 2_000), Some(0));
        pwr.write(0x00, 7 << 5 | 1 << PVDE, &mut bench.at(0));
        assert_eq!(pwr.read(0x04, 2_779), Some(1 << 2));
        assert_eq!(pwr.read(0x04, 2_780), Some(0));
        assert_eq!(bench.reported(), []);
    }
}
