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

/// Limits of the clocks (7.2): shortest cycles of the system clock and of APB1.
const SYSCLK_LIMIT: Ticks = TICKS_PER_SECOND / (72 * MHZ);
const PCLK1_LIMIT: Ticks = TICKS_PER_SECOND / (36 * MHZ);

/// The sources of the clocks, as one chip and its board have them.
#[derive(Clone, Copy, Debug)]
pub struct Sources {
    /// Whether the crystal starts.
    pub crystal: bool,
    /// Whether the PLL locks.
    pub pll: bool,
    /// A cycle of the crystal; a multiple of nine ticks, as the PLL multiplies by up to nine.
    pub external: Ticks,
    /// A cycle of the internal oscillator; a multiple of eight ticks.
    pub internal: Ticks,
    /// From a write of SW to the switch of the clock. The manual gives no time.
    pub switching: Ticks,
}

impl Sources {
    /// Sources with an internal oscillator that is off by `error` of its 8 MHz (DS5319: -2 to +2.5 % over the
    /// temperature).
    pub fn new(crystal: bool, pll: bool, error: f64, switching: Ticks) -> Self {
        let eighth = TICKS_PER_SECOND as f64 / (64e6 * (1.0 + error));
        Self {
            crystal,
            pll,
            external: 9 * (TICKS_PER_SECOND / (72 * MHZ)),
            internal: 8 * eighth.round() as Ticks,
            switching,
        }
    }
}

impl Sources {
    /// The same with a crystal that is off by `error` of its 8 MHz.
    #[must_use]
    pub fn with_crystal(mut self, error: f64) -> Self {
        let ninth = TICKS_PER_SECOND as f64 / (72e6 * (1.0 + error));
        self.external = 9 * ninth.round() as Ticks;
        self
    }
}

#[cfg(test)]
impl Default for Sources {
    fn default() -> Self {
        Self::new(true, true, 0.0, microseconds(2))
    }
}

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

#[derive(Debug)]
pub struct Rcc {
    sources: Sources,
    cr: u32,
    cfgr: u32,
    /// The source of the system clock (SWS), and when the one in SW takes its place.
    source: u32,
    switches: Option<Ticks>,
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
    /// The clocks of a chip before its first reset.
    pub fn new(sources: Sources) -> Self {
        Self {
            sources,
            cr: 0x83,
            cfgr: 0,
            source: 0,
            switches: None,
            cir: 0,
            apb2rstr: 0,
            apb1rstr: 0,
            enr: [0x14, 0, 0],
            csr: 0,
            hse_since: 0,
            pll_since: 0,
            lsi_since: 0,
        }
    }

    /// The clocks without supply.
    pub fn switch_off(&mut self) {
        *self = Self::new(self.sources);
    }

    /// A reset. All registers but the flags in CSR go to their reset values (7.1.1); every reset
    /// pulls the reset pin low (7.1.1, figure of the reset circuit), so its flag is set as well.
    pub fn reset(&mut self, reason: ResetReason) {
        const PIN: u32 = 1 << 26;
        let flag = match reason {
            ResetReason::Pin => PIN,
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
        *self = Self::new(self.sources);
        self.csr = before | flag | PIN;
    }

    /// The clocks as the bootloader leaves them to a program: 24 MHz from the PLL on the internal oscillator (AN2606), with
    /// the clocks of its port and of USART1 on. AN3155 says that it resets what it has used; stm32duino found the PLL in
    /// use all the same (pull request 1653).
    pub fn leave_bootloader(&mut self, now: Ticks) {
        const PLL_BY_SIX: u32 = 4 << 18;
        const PLL: u32 = 2;
        self.cr |= 1 << PLLON;
        self.cfgr = PLL_BY_SIX | PLL;
        self.source = PLL;
        self.pll_since = now.saturating_sub(PLL_LOCK);
        self.enr[Domain::Apb2 as usize] = 1 << 14 | 1 << 2;
    }

    fn ready(on: bool, since: Ticks, startup: Ticks, now: Ticks) -> bool {
        on && now >= since + startup
    }

    fn hse_ready(&self, now: Ticks) -> bool {
        self.sources.crystal && Self::ready(bit(self.cr, HSEON), self.hse_since, HSE_STARTUP, now)
    }

    fn pll_ready(&self, now: Ticks) -> bool {
        let source = !bit(self.cfgr, 16) || self.hse_ready(now);
        self.sources.pll
            && source
            && Self::ready(bit(self.cr, PLLON), self.pll_since, PLL_LOCK, now)
    }

    /// A cycle of the PLL's output (7.3.2: PLLSRC, PLLXTPRE, PLLMUL); `None` where it is no whole number of ticks.
    fn pll(&self) -> Option<Ticks> {
        let source = match (bit(self.cfgr, 16), bit(self.cfgr, 17)) {
            (false, _) => 2 * self.sources.internal,
            (true, true) => 2 * self.sources.external,
            (true, false) => self.sources.external,
        };
        // 1110 and 1111 are both 16.
        let factor = Ticks::from((field(self.cfgr, 18, 4) + 2).min(16));
        source.is_multiple_of(factor).then_some(source / factor)
    }

    /// A cycle of the clock from `source`, a value of SW.
    fn cycle(&self, source: u32) -> Option<Ticks> {
        match source {
            0 => Some(self.sources.internal),
            1 => Some(self.sources.external),
            _ => self.pll(),
        }
    }

    /// A cycle of the system clock. A source without a whole number of ticks is not switched to.
    fn sysclk(&self) -> Ticks {
        self.cycle(self.source).unwrap_or(self.sources.internal)
    }

    /// Frequency of the system clock (MHz), for the rules that depend on it: that of the source that is being
    /// switched to, if it is the faster one.
    pub fn sysclk_mhz(&self) -> u64 {
        let next = self
            .switches
            .and_then(|_| self.cycle(field(self.cfgr, 0, 2)));
        let cycle = next.map_or(self.sysclk(), |next| next.min(self.sysclk()));
        TICKS_PER_SECOND.div_ceil(cycle * MHZ)
    }

    /// The time of the next event: the switch of the system clock.
    pub fn next_event(&self) -> Option<Ticks> {
        self.switches
    }

    /// Handles the event at `now`; returns whether the clocks are others now.
    pub fn advance(&mut self, now: Ticks) -> bool {
        let switches = self.switches.take_if(|at| *at <= now).is_some();
        if switches {
            self.source = field(self.cfgr, 0, 2);
        }
        switches
    }

    /// The clocks as they are now.
    pub fn clocks(&self) -> Clocks {
        let hclk = self.sysclk() * ahb_divider(field(self.cfgr, 4, 4));
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
        self.sources.crystal = false;
        let from_crystal = match self.source {
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
                (self.source, self.switches) = (0, None);
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
            // SWS follows SW late. A switch to a clock that is not ready is reported and not made.
            0x04 => self.cfgr | self.source << 2,
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
            0x14 | 0x18 | 0x1c => {
                let enabled = &mut self.enr[(offset - 0x14) as usize / 4];
                let stops = *enabled & !value != 0;
                m.not_modelled(stops, "a unit whose clock is switched off again");
                *enabled = value;
            }
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
        let used = match self.source {
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
        let wanted = value & 3;
        let odd = self.cycle(wanted).is_none();
        m.not_modelled(odd, "a system clock that is no whole number of ticks");
        if odd {
            self.cfgr = before;
        }
        self.switch(before & 3, m);
        let fast = self
            .cycle(value & 3)
            .is_some_and(|cycle| cycle < SYSCLK_LIMIT);
        m.against_manual(fast, "the system clock is above 72 MHz (7.2)");
        let divider = apb_divider(field(self.cfgr, 8, 3)) * ahb_divider(field(self.cfgr, 4, 4));
        let pclk1 = self.cycle(self.cfgr & 3).unwrap_or(SYSCLK_LIMIT) * divider;
        m.against_manual(pclk1 < PCLK1_LIMIT, "PCLK1 is above 36 MHz (7.2)");
    }

    /// The system clock goes to the source in SW, a while later. Before that SW must stay as it is: the manual does not
    /// say which of two switches takes place.
    fn switch(&mut self, before: u32, m: &mut Moment<'_>) {
        let wanted = field(self.cfgr, 0, 2);
        if wanted == before {
            return;
        }
        let early = self.switches.is_some();
        m.against_manual(early, "SW was written again before SWS followed (7.3.2)");
        self.switches = Some(m.now + self.sources.switching);
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
