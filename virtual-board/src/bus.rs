//! From addresses to registers (RM0008 3.3, register boundary addresses).

use crate::chip::Chip;
use crate::cpu::Bus;
use crate::peripherals::Moment;
use crate::peripherals::adc::Adc;
use crate::peripherals::afio::Afio;
use crate::peripherals::gpio::Gpio;
use crate::peripherals::pwr::Pwr;
use crate::peripherals::rcc::Domain;
use crate::peripherals::tim::Tim;
use crate::peripherals::usart::Usart;
use crate::record::Irregularity;
use crate::time::Ticks;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// The unit at an address.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Unit {
    Tim2,
    Tim3,
    Tim4,
    Pwr,
    Exti,
    Iwdg,
    Afio,
    Gpio(usize),
    Adc1,
    Usart1,
    Dma1,
    Rcc,
    Flash,
    Dbgmcu,
}

/// A bit in the enable register of a domain; none where the clock is always on.
type Enable = Option<(Domain, u32)>;

/// Each unit: its base address, and its enable bit unless its clock is always on (7.3.6-7.3.8).
const UNITS: [(u32, Unit, Enable); 18] = [
    (0x4000_0000, Unit::Tim2, Some((Domain::Apb1, 0))),
    (0x4000_0400, Unit::Tim3, Some((Domain::Apb1, 1))),
    (0x4000_0800, Unit::Tim4, Some((Domain::Apb1, 2))),
    (0x4000_3000, Unit::Iwdg, None),
    (0x4000_7000, Unit::Pwr, Some((Domain::Apb1, 28))),
    (0x4001_0000, Unit::Afio, Some((Domain::Apb2, 0))),
    (0x4001_0400, Unit::Exti, None),
    (0x4001_0800, Unit::Gpio(0), Some((Domain::Apb2, 2))),
    (0x4001_0c00, Unit::Gpio(1), Some((Domain::Apb2, 3))),
    (0x4001_1000, Unit::Gpio(2), Some((Domain::Apb2, 4))),
    (0x4001_1400, Unit::Gpio(3), Some((Domain::Apb2, 5))),
    (0x4001_1800, Unit::Gpio(4), Some((Domain::Apb2, 6))),
    (0x4001_2400, Unit::Adc1, Some((Domain::Apb2, 9))),
    (0x4001_3800, Unit::Usart1, Some((Domain::Apb2, 14))),
    (0x4002_0000, Unit::Dma1, Some((Domain::Ahb, 0))),
    (0x4002_1000, Unit::Rcc, None),
    (0x4002_2000, Unit::Flash, None),
    (0xe004_2000, Unit::Dbgmcu, None),
];
/// Room of each unit.
const UNIT_BYTES: u32 = 0x400;
/// The electronic signature (30.1, 30.2).
const SIGNATURE: u32 = 0x1fff_f7e0;

fn locate(address: u32) -> Option<(Unit, Enable, u32)> {
    UNITS.iter().find_map(|&(base, unit, clock)| {
        let offset = address.checked_sub(base)?;
        (offset < UNIT_BYTES).then_some((unit, clock, offset))
    })
}

impl Chip {
    /// A read of a word by the processor.
    pub fn read_word(&mut self, address: u32, now: Ticks) -> u32 {
        let Some((unit, clock, offset)) = locate(address) else {
            self.unmapped(address, now);
            return 0;
        };
        if !self.is_clocked(clock, address, now) {
            return 0;
        }
        let millivolts = self.supply.millivolts(now);
        let p = &mut self.p;
        let value = match unit {
            Unit::Tim2 => p.tim2.read(offset, now),
            Unit::Tim3 => p.tim3.read(offset, now),
            Unit::Tim4 => p.tim4.read(offset, now),
            Unit::Pwr => p.pwr.read(offset, millivolts),
            Unit::Exti => p.exti.read(offset),
            Unit::Iwdg => p.iwdg.read(offset, now),
            Unit::Afio => p.afio.read(offset),
            // The line's idle level at PA10; nothing else drives a pin that is read.
            Unit::Gpio(0) => p.gpio[0].read(offset, 1 << 10),
            Unit::Gpio(port) => p.gpio[port].read(offset, 0),
            Unit::Adc1 => p.adc.read(offset, now),
            Unit::Usart1 => p.usart.read(offset),
            Unit::Dma1 => p.dma.read(offset),
            Unit::Rcc => self.rcc.read(offset, now),
            Unit::Flash => p.flash.read(offset),
            Unit::Dbgmcu => p.dbgmcu.read(offset),
        };
        value.unwrap_or_else(|| {
            self.unmapped(address, now);
            0
        })
    }

    /// A write of a word by the processor.
    pub fn write_word(&mut self, address: u32, value: u32, now: Ticks) {
        let Some((unit, clock, offset)) = locate(address) else {
            self.unmapped(address, now);
            return;
        };
        if !self.is_clocked(clock, address, now) {
            return;
        }
        if self.write_unit(unit, offset, value, now).is_none() {
            self.unmapped(address, now);
        }
        self.follow_pulse(now);
    }

    fn write_unit(&mut self, unit: Unit, offset: u32, value: u32, now: Ticks) -> Option<()> {
        let sysclk_mhz = self.rcc.sysclk_mhz();
        let record = &mut self.record;
        let m = &mut Moment { now, record };
        let p = &mut self.p;
        match unit {
            Unit::Tim2 => {
                let trigger = p.tim2.write(offset, value, m)?;
                self.on_tim2_trigger(trigger, now);
                self.follow_probe(now);
                Some(())
            }
            Unit::Tim3 => {
                let trigger = p.tim3.write(offset, value, m)?;
                self.on_tim3_trigger(trigger, now);
                Some(())
            }
            Unit::Tim4 => {
                let trigger = p.tim4.write(offset, value, m)?;
                m.not_modelled(trigger, "the trigger output of TIM4");
                Some(())
            }
            Unit::Pwr => {
                p.pwr.write(offset, value, m)?;
                self.advance_detector(now);
                Some(())
            }
            Unit::Exti => p.exti.write(offset, value, m),
            Unit::Iwdg => p.iwdg.write(offset, value, m),
            Unit::Afio => p.afio.write(offset, value, m),
            Unit::Gpio(port) => p.gpio[port].write(offset, value, m),
            Unit::Adc1 => p.adc.write(offset, value, m),
            Unit::Usart1 => p.usart.write(offset, value, m),
            Unit::Dma1 => p.dma.write(offset, value, m),
            Unit::Rcc => self.write_rcc(offset, value, now),
            Unit::Flash => p.flash.write(offset, value, sysclk_mhz, m),
            Unit::Dbgmcu => p.dbgmcu.write(offset, value, m),
        }
    }

    fn write_rcc(&mut self, offset: u32, value: u32, now: Ticks) -> Option<()> {
        let record = &mut self.record;
        let m = &mut Moment { now, record };
        let (domain, resets) = self.rcc.write(offset, value, m)?;
        self.p.flash.check(self.rcc.sysclk_mhz(), m);
        self.distribute_clocks(now);
        for (_, unit, clock) in UNITS {
            if let Some((of, bit)) = clock
                && of == domain
                && resets >> bit & 1 != 0
            {
                self.reset_unit(unit);
            }
        }
        Some(())
    }

    fn reset_unit(&mut self, unit: Unit) {
        let clocks = self.rcc.clocks();
        let p = &mut self.p;
        match unit {
            Unit::Tim2 => p.tim2 = Tim::new(clocks.timers),
            Unit::Tim3 => p.tim3 = Tim::new(clocks.timers),
            Unit::Tim4 => p.tim4 = Tim::new(clocks.timers),
            Unit::Pwr => p.pwr = Pwr::default(),
            Unit::Afio => p.afio = Afio::default(),
            Unit::Gpio(port) => p.gpio[port] = Gpio::default(),
            Unit::Adc1 => p.adc = Adc::new(clocks.adc),
            Unit::Usart1 => p.usart = Usart::new(clocks.pclk2),
            // These have no bit of their own in a reset register.
            Unit::Iwdg | Unit::Exti | Unit::Dma1 | Unit::Rcc | Unit::Flash | Unit::Dbgmcu => {}
        }
    }

    fn is_clocked(&mut self, clock: Enable, address: u32, now: Ticks) -> bool {
        let clocked = clock.is_none_or(|(domain, bit)| self.rcc.is_enabled(domain, bit));
        let what = Irregularity::Unclocked(address);
        self.moment(now).report_if(!clocked, what);
        clocked
    }

    /// Some units have registers of half a word and may be accessed by half words (15.4, 19.4, 27.6), which ignore the
    /// other half. All others are accessed by words.
    fn check_width(&mut self, address: u32, bytes: u32, now: Ticks) {
        let halves = locate(address).is_some_and(|(unit, ..)| {
            matches!(
                unit,
                Unit::Tim2 | Unit::Tim3 | Unit::Tim4 | Unit::Iwdg | Unit::Usart1
            )
        });
        let good = bytes == 4 || bytes == 2 && halves && address.is_multiple_of(4);
        let what = Irregularity::Narrow(address);
        self.moment(now).report_if(!good, what);
    }

    /// The signature is memory: it may be read by bytes.
    fn read_signature(&mut self, address: u32, bytes: u32, now: Ticks) -> u32 {
        let sysclk_mhz = self.rcc.sysclk_mhz();
        let byte = |n: u32| {
            let offset = (address + n).checked_sub(SIGNATURE)?;
            self.signature.read_byte(offset, sysclk_mhz)
        };
        let value = (0..bytes).try_fold(0, |value, n| Some(value | u32::from(byte(n)?) << (8 * n)));
        value.unwrap_or_else(|| {
            self.unmapped(address, now);
            0
        })
    }
}

/// The chip as the core's bus sees it, and their common clock.
#[derive(Debug)]
pub struct SharedChip {
    chip: Mutex<Chip>,
    now: AtomicU64,
    touched: AtomicBool,
}

impl SharedChip {
    /// Shares `chip`.
    pub fn new(chip: Chip) -> Self {
        Self {
            chip: Mutex::new(chip),
            now: AtomicU64::new(0),
            touched: AtomicBool::new(true),
        }
    }

    /// The chip. The core holds it only during a step.
    pub fn lock(&self) -> MutexGuard<'_, Chip> {
        self.chip.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The time at which the core's next accesses happen.
    pub fn set_now(&self, now: Ticks) {
        self.now.store(now, Ordering::Relaxed);
    }

    /// Whether the core accessed a peripheral since the last call.
    pub fn take_touched(&self) -> bool {
        // Called before each step: a plain load is much cheaper than a swap.
        self.touched.load(Ordering::Relaxed) && self.touched.swap(false, Ordering::Relaxed)
    }

    fn access(&self) -> (MutexGuard<'_, Chip>, Ticks) {
        self.touched.store(true, Ordering::Relaxed);
        (self.lock(), self.now.load(Ordering::Relaxed))
    }
}

impl Bus for SharedChip {
    fn read(&self, address: u32, bytes: u32) -> u32 {
        let (mut chip, now) = self.access();
        if address & 0xffff_f000 == SIGNATURE & 0xffff_f000 {
            return chip.read_signature(address, bytes, now);
        }
        chip.check_width(address, bytes, now);
        chip.read_word(address & !3, now) >> (8 * (address & 3))
    }

    fn write(&self, address: u32, bytes: u32, value: u32) {
        let (mut chip, now) = self.access();
        chip.check_width(address, bytes, now);
        chip.write_word(address & !3, value, now);
    }
}

#[cfg(test)]
mod tests;
