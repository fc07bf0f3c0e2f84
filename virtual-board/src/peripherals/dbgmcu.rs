//! Debug support (RM0008 31.16.3).

use super::Moment;

/// Medium-density device, revision Y (31.6.1).
const IDCODE: u32 = 0x2003_6410;

/// No debugger is ever attached, so CR has no effect. A program that sets it all the same drains a
/// battery, or stops the watchdog on the bench.
#[derive(Debug, Default)]
pub struct Dbgmcu {
    cr: u32,
}

impl Dbgmcu {
    pub fn read(&self, offset: u32) -> Option<u32> {
        match offset {
            0x00 => Some(IDCODE),
            0x04 => Some(self.cr),
            _ => None,
        }
    }

    pub fn write(&mut self, offset: u32, value: u32, m: &mut Moment<'_>) -> Option<()> {
        match offset {
            0x00 => {}
            0x04 => {
                m.against_manual(value != 0, "debug settings without a debugger");
                self.cr = value;
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
    fn the_device_is_a_medium_density_one() {
        assert_eq!(Dbgmcu::default().read(0).unwrap() & 0xfff, 0x410);
    }

    #[test]
    fn a_debug_setting_is_kept_and_reported() {
        let (mut dbgmcu, mut bench) = (Dbgmcu::default(), Bench::default());
        dbgmcu.write(4, 1, &mut bench.at(0));
        assert_eq!(dbgmcu.read(4), Some(1));
        assert_eq!(bench.reported().len(), 1);
    }
}
