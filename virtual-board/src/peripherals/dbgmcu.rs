//! Debug support (RM0008 31.16.3).

use super::{Moment, bit};

/// Medium-density device, revision Y (31.6.1).
const IDCODE: u32 = 0x2003_6410;

/// Bits of CR that stop a unit while the processor is halted.
const IWDG_STOP: u32 = 8;
const TIM2_STOP: u32 = 11;
const TIM3_STOP: u32 = 12;
const TIM4_STOP: u32 = 13;

/// The debug support. Only a loss of the supply resets it.
///
/// Without a debugger, programs read its registers as 0 and cannot write them (errata sheet ES096, "Debug registers
/// cannot be read by user software").
#[derive(Debug, Default)]
pub struct Dbgmcu {
    attached: bool,
    cr: u32,
}

impl Dbgmcu {
    /// The debug support after the supply came up, with or without a debugger. One that is attached has set every bit
    /// that stops a unit, as scripts of debuggers do, and as an earlier program may have done.
    pub fn new(attached: bool) -> Self {
        Self {
            attached,
            cr: if attached { 0x0000_3f07 } else { 0 },
        }
    }

    /// Whether the watchdog stands still while the processor is halted.
    pub fn stops_watchdog(&self) -> bool {
        bit(self.cr, IWDG_STOP)
    }

    /// Whether timer 2, 3 or 4 stands still while the processor is halted.
    pub fn stops_timer(&self, number: u32) -> bool {
        let stop = match number {
            2 => TIM2_STOP,
            3 => TIM3_STOP,
            _ => TIM4_STOP,
        };
        bit(self.cr, stop)
    }

    pub fn read(&self, offset: u32) -> Option<u32> {
        let value = match offset {
            0x00 => IDCODE,
            0x04 => self.cr,
            _ => return None,
        };
        Some(if self.attached { value } else { 0 })
    }

    pub fn write(&mut self, offset: u32, value: u32, m: &mut Moment<'_>) -> Option<()> {
        match offset {
            0x00 => {}
            0x04 => {
                // Standby and stop modes with the clocks on: a battery is drained.
                m.against_manual(value & 0b110 != 0, "debugging in modes that are not used");
                if self.attached {
                    self.cr = value;
                }
            }
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
    fn the_registers_are_there_for_a_debugger_only() {
        let mut bench = Bench::default();
        for attached in [false, true] {
            let mut dbgmcu = Dbgmcu::new(attached);
            assert_eq!(dbgmcu.read(0).unwrap() & 0xfff == 0x410, attached);
            assert_eq!(dbgmcu.stops_timer(2) && dbgmcu.stops_watchdog(), attached);
            dbgmcu.write(4, 1, &mut bench.at(0));
            assert_eq!(dbgmcu.read(4), Some(u32::from(attached)));
            assert!(!dbgmcu.stops_timer(2) && !dbgmcu.stops_watchdog());
        }
        assert_eq!(bench.reported(), []);
    }
}
