//! Reset and clock control (RM0008 chapter 7).

use super::{Moment, bit, field};
use crate::record::ResetReason;
use crate::time::{TICKS_PER_SECOND, Ticks, microseconds};

/// Start-up of the crystal (datasheet DS5319, table "HSE 4-16 MHz oscillator characteristics").
const HSE_STARTUP: Ticks = microseconds(2_000);
/// The longest time that the PLL needs to lock (DS5319, table "PLL characteristics").
const PLL_LOCK: Ticks = microseconds(200);
/// Start-up of the low-speed oscillator (DS5319, table "LSI oscillator characteristics").
const LSI_STARTUP: Ticks = microseconds(85);

const MHZ: u64 = 1_000_000;
/// Both the internal oscillator and the crystal of the usual boards.
const OSCILLATOR: u64 = 8 * MHZ;

/// Limits of the clocks (7.2): system, APB1.
const SYSCLK_LIMIT: u64 = 72 * MHZ;
const PCLK1_LIMIT: u64 = 36 * MHZ;

/// Ticks per cycle of each clock.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Clocks {
    /// Processor, memory and DMA.
    pub hclk: Ticks,
    pub pclk1: Ticks,
    pub pclk2: Ticks,
    /// Timers on APB1.
    pub timers: Ticks,
    pub adc: Ticks,
}

/// A bus whose peripherals are enabled and reset one by one (7.3.6-7.3.8).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Domain {
    Ahb,
    Apb2,
    Apb1,
}

#[derive(Debug, Default)]
pub struct Rcc {
    /// Whether the crystal starts.
    pub crystal: bool,
    cr: u32,
    cfgr: u32,
    cir: u32,
    apb2rstr: u32,
    apb1rstr: u32,
    /// The enable registers of AHB, APB2 and APB1.
    enr: [u32; 3],
    csr: u32,
    hse_since: Ticks,
    pll_since: Ticks,
    lsi_since: Ticks,
}

/// The clock security system has seen the crystal stop (7.3.3).
const CSSF: u32 = 1 << 7;

const HSION: u32 = 0;
const CSSON: u32 = 19;
const HSEON: u32 = 16;
const PLLON: u32 = 24;
const LSION: u32 = 0;

impl Rcc {
    /// The clocks of a chip with or without a crystal that starts, before its first reset.
    pub fn new(crystal: bool) -> Self {
        Self {
            crystal,
            cr: 0x83,
            enr: [0x14, 0, 0],
            ..Self::default()
        }
    }

    /// A reset. All registers but the flags in CSR go to their reset values (7.1.1); every reset
    /// pulls the reset pin low (7.1.1, figure of the reset circuit), so its flag is set as well.
    pub fn reset(&mut self, reason: ResetReason) {
        const PIN: u32 = 1 << 26;
        let flag = match reason {
            ResetReason::PowerOn => 1 << 27,
            ResetReason::Software => 1 << 28,
            ResetReason::Watchdog => 1 << 29,
        };
        // A loss of the supply clears the flags of earlier resets.
        let kept = if reason == ResetReason::PowerOn {
            0
        } else {
            0xfc00_0000
        };
        let before = self.csr & kept;
        *self = Self::new(self.crystal);
        self.csr = before | flag | PIN;
    }

    fn ready(on: bool, since: Ticks, startup: Ticks, now: Ticks) -> bool {
        on && now >= since + startup
    }

    fn hse_ready(&self, now: Ticks) -> bool {
        self.crystal && Self::ready(bit(self.cr, HSEON), self.hse_since, HSE_STARTUP, now)
    }

    fn pll_ready(&self, now: Ticks) -> bool {
        let source = !bit(self.cfgr, 16) || self.hse_ready(now);
        source && Self::ready(bit(self.cr, PLLON), self.pll_since, PLL_LOCK, now)
    }

    /// Frequency of the PLL's output (7.3.2: PLLSRC, PLLXTPRE, PLLMUL).
    fn pll_hz(&self) -> u64 {
        let source = match (bit(self.cfgr, 16), bit(self.cfgr, 17)) {
            (false, _) | (true, true) => OSCILLATOR / 2,
            (true, false) => OSCILLATOR,
        };
        // 1110 and 1111 are both 16.
        source * u64::from((field(self.cfgr, 18, 4) + 2).min(16))
    }

    fn sysclk_hz(&self) -> u64 {
        match field(self.cfgr, 0, 2) {
            2 => self.pll_hz(),
            _ => OSCILLATOR,
        }
    }

    /// Frequency of the system clock (MHz), for the rules that depend on it.
    pub fn sysclk_mhz(&self) -> u64 {
        self.sysclk_hz() / MHZ
    }

    /// The clocks as they are now.
    pub fn clocks(&self) -> Clocks {
        let hclk = TICKS_PER_SECOND / self.sysclk_hz() * ahb_divider(field(self.cfgr, 4, 4));
        let (div1, div2) = (
            apb_divider(field(self.cfgr, 8, 3)),
            apb_divider(field(self.cfgr, 11, 3)),
        );
        let pclk2 = hclk * div2;
        Clocks {
            hclk,
            pclk1: hclk * div1,
            pclk2,
            // 7.2, clock tree: twice PCLK1 unless that is not divided.
            timers: if div1 == 1 { hclk } else { hclk * div1 / 2 },
            adc: pclk2 * u64::from(2 * (field(self.cfgr, 14, 2) + 1)),
        }
    }

    /// Whether the peripheral at `bit_number` of its enable register has a clock.
    pub fn is_enabled(&self, domain: Domain, bit_number: u32) -> bool {
        bit(self.enr[domain as usize], bit_number)
    }

    /// The crystal stops for ever. With the clock security system on (7.2.7), the chip goes on with its
    /// internal oscillator, PLL and crystal are switched off, and the NMI is raised. Without it, a
    /// chip that runs from the crystal stands still: that is not modelled.
    pub fn stop_crystal(&mut self, m: &mut Moment<'_>) {
        self.crystal = false;
        let from_crystal = match field(self.cfgr, 0, 2) {
            0 => false,
            1 => true,
            _ => bit(self.cfgr, 16),
        };
        if bit(self.cr, CSSON) && bit(self.cr, HSEON) {
            self.cr &= !(1 << HSEON | 1 << CSSON);
            self.cir |= CSSF;
            if from_crystal {
                self.cr = self.cr & !(1 << PLLON) | 1 << HSION;
                self.cfgr &= !3;
            }
        } else {
            m.not_modelled(from_crystal, "a chip without any clock");
        }
    }

    /// Whether the NMI is raised: as long as CSSF is set (7.2.7).
    pub fn nmi(&self) -> bool {
        self.cir & CSSF != 0
    }

    pub fn read(&self, offset: u32, now: Ticks) -> Option<u32> {
        let ready = |is_ready: bool, n: u32| u32::from(is_ready) << n;
        Some(match offset {
            0x00 => {
                self.cr
                    | ready(bit(self.cr, HSION), 1)
                    | ready(self.hse_ready(now), 17)
                    | ready(self.pll_ready(now), 25)
            }
            // SWS mirrors SW: a switch to a clock that is not ready is reported and not made.
            0x04 => self.cfgr | field(self.cfgr, 0, 2) << 2,
            0x08 => self.cir,
            0x0c => self.apb2rstr,
            0x10 => self.apb1rstr,
            0x14 | 0x18 | 0x1c => self.enr[(offset - 0x14) as usize / 4],
            0x20 => 0,
            0x24 => {
                let lsi = Self::ready(bit(self.csr, LSION), self.lsi_since, LSI_STARTUP, now);
                self.csr | ready(lsi, 1)
            }
            _ => return None,
        })
    }

    /// Writes the register at `offset`. Returns the peripherals that this resets, as a domain and
    /// the bits of its reset register; `None` where there is no such register.
    pub fn write(&mut self, offset: u32, value: u32, m: &mut Moment<'_>) -> Option<(Domain, u32)> {
        let mut resets = (Domain::Ahb, 0);
        match offset {
            0x00 => self.write_cr(value, m),
            0x04 => self.write_cfgr(value, m),
            0x08 => {
                m.not_modelled(value & 0x1f00 != 0, "clock interrupts (RCC_CIR)");
                // CSSC clears CSSF (7.3.3).
                let failed = self.cir & CSSF;
                self.cir = value & 0x1f00 | if bit(value, 23) { 0 } else { failed };
            }
            0x0c => {
                resets = (Domain::Apb2, value & !self.apb2rstr);
                self.apb2rstr = value;
            }
            0x10 => {
                resets = (Domain::Apb1, value & !self.apb1rstr);
                self.apb1rstr = value;
            }
            0x14 | 0x18 | 0x1c => self.enr[(offset - 0x14) as usize / 4] = value,
            0x20 => m.not_modelled(value != 0, "the backup domain"),
            0x24 => {
                if bit(value, LSION) && !bit(self.csr, LSION) {
                    self.lsi_since = m.now;
                }
                // RMVF clears all flags (7.3.10).
                let kept = if bit(value, 24) { 0 } else { 0xfc00_0000 };
                self.csr = self.csr & kept | value & 1;
            }
            _ => return None,
        }
        Some(resets)
    }

    fn write_cr(&mut self, value: u32, m: &mut Moment<'_>) {
        // Writable: HSION, HSITRIM, HSEON, HSEBYP, CSSON, PLLON.
        let value = value & 0x010d_00f9 | self.cr & 0xff00;
        if bit(value, HSEON) && !bit(self.cr, HSEON) {
            self.hse_since = m.now;
        }
        if bit(value, PLLON) && !bit(self.cr, PLLON) {
            self.pll_since = m.now;
        }
        // 7.3.1: a clock in use cannot be switched off.
        let used = match field(self.cfgr, 0, 2) {
            0 => 1 << HSION,
            1 => 1 << HSEON,
            _ if bit(self.cfgr, 16) => 1 << PLLON | 1 << HSEON,
            _ => 1 << PLLON | 1 << HSION,
        };
        let switched_off = self.cr & used & !value != 0;
        m.against_manual(switched_off, "a clock in use was switched off (7.3.1)");
        self.cr = value | self.cr & used;
    }

    fn write_cfgr(&mut self, value: u32, m: &mut Moment<'_>) {
        const PLL_FIELDS: u32 = 0x003f_0000;
        let mut value = value & 0x077f_fff3;
        let changed = bit(self.cr, PLLON) && (value ^ self.cfgr) & PLL_FIELDS != 0;
        m.against_manual(changed, "the PLL was changed while on (7.3.2)");
        if changed {
            value = value & !PLL_FIELDS | self.cfgr & PLL_FIELDS;
        }
        let ready = match value & 3 {
            0 => bit(self.cr, HSION),
            1 => self.hse_ready(m.now),
            2 => self.pll_ready(m.now),
            _ => false,
        };
        m.not_modelled(!ready, "a switch to a clock that is not ready");
        if !ready {
            value = value & !3 | self.cfgr & 3;
        }
        let before = self.cfgr;
        self.cfgr = value;
        let odd = !TICKS_PER_SECOND.is_multiple_of(self.sysclk_hz());
        m.not_modelled(odd, "a system clock that 576 MHz is no multiple of");
        if odd {
            self.cfgr = before;
        }
        let fast = self.sysclk_hz() > SYSCLK_LIMIT;
        m.against_manual(fast, "the system clock is above 72 MHz (7.2)");
        let pclk1 = TICKS_PER_SECOND / self.clocks().pclk1;
        m.against_manual(pclk1 > PCLK1_LIMIT, "PCLK1 is above 36 MHz (7.2)");
    }
}

/// HPRE (7.3.2): 0xxx not divided; 1000 by 2 and so on, without 32.
fn ahb_divider(code: u32) -> u64 {
    match code {
        0..8 => 1,
        8..12 => 2 << (code - 8),
        _ => 4 << (code - 8),
    }
}

/// PPRE (7.3.2): 0xx not divided; 100 by 2 and so on.
fn apb_divider(code: u32) -> u64 {
    if code < 4 { 1 } else { 2 << (code - 4) }
}

#[cfg(test)]
mod tests;
