//! One port of general-purpose pins (RM0008 9.1, 9.2).

use super::{Moment, bit, field};

/// The configuration of a pin (table "Port bit configuration table").
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    Analog,
    /// Digital input, floating or pulled.
    Input,
    /// Output of the port's own data register.
    Output,
    /// Output of a peripheral, driven both ways.
    AlternatePushPull,
    /// Output of a peripheral, driven low only.
    AlternateOpenDrain,
    /// Not allowed.
    Reserved,
}

#[derive(Debug)]
pub struct Gpio {
    /// CRL and CRH.
    cr: [u32; 2],
    odr: u32,
}

impl Default for Gpio {
    /// Out of reset: all pins are floating inputs (9.2.1).
    fn default() -> Self {
        Self {
            cr: [0x4444_4444; 2],
            odr: 0,
        }
    }
}

impl Gpio {
    /// The configuration of `pin`.
    pub fn mode(&self, pin: u32) -> Mode {
        let [low, high] = self.cr;
        let configuration = field(if pin < 8 { low } else { high }, pin % 8 * 4, 4);
        match (configuration & 3, configuration >> 2) {
            (0, 0) => Mode::Analog,
            (0, 1 | 2) => Mode::Input,
            (0, _) => Mode::Reserved,
            (_, 0 | 1) => Mode::Output,
            (_, 2) => Mode::AlternatePushPull,
            (_, _) => Mode::AlternateOpenDrain,
        }
    }

    /// Whether `pin` is an input that nothing pulls: where nothing drives it from outside, its level is by chance.
    pub fn floats(&self, pin: u32) -> bool {
        let [low, high] = self.cr;
        field(if pin < 8 { low } else { high }, pin % 8 * 4, 4) == 0b0100
    }

    /// The level that the port itself gives `pin`: as output, or through its pull-up.
    pub fn level(&self, pin: u32) -> bool {
        bit(self.odr, pin)
    }

    /// Reads the register at `offset`; `None` where there is none. `levels` are those of the pins
    /// that something outside drives.
    pub fn read(&self, offset: u32, levels: u32) -> Option<u32> {
        Some(match offset {
            0x00 => self.cr[0],
            0x04 => self.cr[1],
            0x08 => {
                let outputs = (0..16)
                    .filter(|&pin| self.mode(pin) == Mode::Output)
                    .fold(0, |bits, pin| bits | 1 << pin);
                self.odr & outputs | levels & !outputs
            }
            0x0c => self.odr,
            0x10 | 0x14 | 0x18 => 0,
            _ => return None,
        })
    }

    pub fn write(&mut self, offset: u32, value: u32, m: &mut Moment<'_>) -> Option<()> {
        match offset {
            0x00 => self.cr[0] = value,
            0x04 => self.cr[1] = value,
            0x08 => {}
            0x0c => self.odr = value & 0xffff,
            // 9.2.5: where both bits are set, the setting one wins.
            0x10 => self.odr = self.odr & !(value >> 16) | value & 0xffff,
            0x14 => self.odr &= !(value & 0xffff),
            0x18 => m.not_modelled(true, "locking of pins"),
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
    fn out_of_reset_every_pin_floats() {
        let gpio = Gpio::default();
        assert!((0..16).all(|pin| gpio.mode(pin) == Mode::Input && gpio.floats(pin)));
    }

    #[test]
    fn the_configuration_table() {
        let (mut gpio, mut bench) = (Gpio::default(), Bench::default());
        // CNF:MODE of pins 8 to 15.
        let table = [
            (0b0000, Mode::Analog),
            (0b0100, Mode::Input),
            (0b1000, Mode::Input),
            (0b0001, Mode::Output),
            (0b0111, Mode::Output),
            (0b1011, Mode::AlternatePushPull),
            (0b1110, Mode::AlternateOpenDrain),
            (0b1100, Mode::Reserved),
        ];
        let crh = (0..)
            .zip(table)
            .fold(0, |w, (n, (cnf, _))| w | cnf << (4 * n));
        gpio.write(0x04, crh, &mut bench.at(0));
        for (pin, (cnf, mode)) in (8..).zip(table) {
            assert_eq!(gpio.mode(pin), mode, "pin {pin}");
            assert_eq!(gpio.floats(pin), cnf == 0b0100, "pin {pin}");
        }
    }

    #[test]
    fn set_and_reset_touch_their_own_bits() {
        let (mut gpio, mut bench) = (Gpio::default(), Bench::default());
        gpio.write(0x0c, 0x00f0, &mut bench.at(0));
        gpio.write(0x10, 0x0010_0003, &mut bench.at(0));
        assert_eq!(gpio.read(0x0c, 0), Some(0x00e3));
        gpio.write(0x10, 0x0001_0001, &mut bench.at(0)); // set wins
        gpio.write(0x14, 0x0002, &mut bench.at(0));
        assert_eq!(gpio.read(0x0c, 0), Some(0x00e1));
        assert!(gpio.level(0) && !gpio.level(1));
    }

    #[test]
    fn inputs_show_what_is_outside_and_outputs_themselves() {
        let (mut gpio, mut bench) = (Gpio::default(), Bench::default());
        gpio.write(0x00, 0x4444_4441, &mut bench.at(0)); // PA0 output
        assert_eq!(gpio.read(0x08, 0b11), Some(0b10));
        gpio.write(0x10, 1, &mut bench.at(0));
        assert_eq!(gpio.read(0x08, 0b10), Some(0b11));
    }
}
