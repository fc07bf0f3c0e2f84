//! External interrupts (RM0008 10.3): line 16, the output of the voltage detector.

use super::{Moment, bit};

/// The line of the voltage detector (10.2.5).
const DETECTOR: u32 = 16;

#[derive(Debug, Default)]
pub struct Exti {
    imr: u32,
    rtsr: u32,
    ftsr: u32,
    pr: u32,
}

impl Exti {
    /// The detector's output has changed to `level`. An edge that is selected sets the pending bit of a line that is not
    /// masked.
    pub fn detector(&mut self, level: bool) {
        let selected = if level { self.rtsr } else { self.ftsr };
        self.pr |= selected & self.imr & 1 << DETECTOR;
    }

    /// Whether line 16 asks for its interrupt.
    pub fn interrupt(&self) -> bool {
        bit(self.pr & self.imr, DETECTOR)
    }

    pub fn read(&self, offset: u32) -> Option<u32> {
        Some(match offset {
            0x00 => self.imr,
            0x04 | 0x10 => 0,
            0x08 => self.rtsr,
            0x0c => self.ftsr,
            0x14 => self.pr,
            _ => return None,
        })
    }

    pub fn write(&mut self, offset: u32, value: u32, m: &mut Moment<'_>) -> Option<()> {
        let other = value & !(1 << DETECTOR) != 0;
        m.not_modelled(other, "another external line than 16");
        match offset {
            0x00 => self.imr = value,
            0x04 | 0x10 => m.not_modelled(value != 0, "events, and interrupts by software"),
            0x08 => self.rtsr = value,
            0x0c => self.ftsr = value,
            // Cleared by writing 1 (10.3.6).
            0x14 => self.pr &= !value,
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
    fn a_selected_edge_stays_until_it_is_cleared() {
        let (mut exti, mut bench) = (Exti::default(), Bench::default());
        exti.write(0x00, 1 << DETECTOR, &mut bench.at(0));
        exti.detector(true);
        assert_eq!(exti.read(0x14), Some(0), "no edge is selected");
        exti.write(0x08, 1 << DETECTOR, &mut bench.at(0));
        exti.detector(true);
        exti.detector(false);
        assert!(exti.interrupt());
        exti.write(0x14, 1 << DETECTOR, &mut bench.at(0));
        assert!(!exti.interrupt());
        assert_eq!(bench.reported(), []);
    }
}
