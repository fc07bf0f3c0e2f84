//! Alternate functions: which pins a peripheral uses (RM0008 9.4).

use super::{Moment, field};

#[derive(Debug, Default)]
pub struct Afio {
    evcr: u32,
    mapr: u32,
}

impl Afio {
    /// Whether TIM2's channel 2 is on PA1: without remapping, and with the second partial one
    /// (9.3.7, table of TIM2 alternate functions).
    pub fn tim2_channel_2_is_on_pa1(&self) -> bool {
        matches!(field(self.mapr, 8, 2), 0b00 | 0b10)
    }

    pub fn read(&self, offset: u32) -> Option<u32> {
        Some(match offset {
            0x00 => self.evcr,
            // 9.4.2: SWJ_CFG is write-only.
            0x04 => self.mapr & !0x0700_0000,
            0x08 | 0x0c | 0x10 | 0x14 => 0,
            _ => return None,
        })
    }

    pub fn write(&mut self, offset: u32, value: u32, m: &mut Moment<'_>) -> Option<()> {
        match offset {
            0x00 => self.evcr = value,
            0x04 => {
                // USART1 on PB6/PB7, ADC1's external triggers: nothing follows them here.
                let remaps = value & (1 << 2 | 1 << 17 | 1 << 18) != 0;
                m.not_modelled(remaps, "remapping of USART1 or of ADC triggers");
                // SWJ_CFG = 100 (9.4.2).
                let closed = field(value, 24, 3) == 0b100;
                m.against_manual(closed, "the debug port was switched off: no probe gets in");
                self.mapr = value;
            }
            0x08 | 0x0c | 0x10 | 0x14 => m.not_modelled(true, "external interrupts"),
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
    fn channel_2_of_tim2_leaves_pa1_with_two_of_the_four_mappings() {
        let (mut afio, mut bench) = (Afio::default(), Bench::default());
        for (remap, on_pa1) in [(0b00, true), (0b01, false), (0b10, true), (0b11, false)] {
            afio.write(0x04, remap << 8, &mut bench.at(0));
            assert_eq!(afio.tim2_channel_2_is_on_pa1(), on_pa1, "{remap:02b}");
        }
        assert_eq!(bench.reported(), []);
    }

    #[test]
    fn a_closed_debug_port_is_reported() {
        let (mut afio, mut bench) = (Afio::default(), Bench::default());
        afio.write(0x04, 0b010 << 24, &mut bench.at(0));
        assert_eq!(bench.reported(), []);
        afio.write(0x04, 0b100 << 24, &mut bench.at(0));
        assert_eq!(bench.reported().len(), 1);
    }

    #[test]
    fn the_debug_port_setting_cannot_be_read() {
        let (mut afio, mut bench) = (Afio::default(), Bench::default());
        afio.write(0x04, 0x0200_0100, &mut bench.at(0));
        assert_eq!(afio.read(0x04), Some(0x0000_0100));
    }
}
