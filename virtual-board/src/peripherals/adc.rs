//! The analog-to-digital converter ADC1 (RM0008 chapter 11): regular sequences, and single injected conversions.

use super::{Moment, bit, field};
use crate::record::{Conversion, Irregularity};
use crate::time::{TICKS_PER_SECOND, Ticks, microseconds};

/// Registers by their offsets (11.12.15).
mod offset {
    pub const SR: u32 = 0x00;
    pub const CR1: u32 = 0x04;
    pub const CR2: u32 = 0x08;
    pub const SMPR1: u32 = 0x0c;
    pub const SMPR2: u32 = 0x10;
    pub const HTR: u32 = 0x24;
    pub const SQR1: u32 = 0x2c;
    pub const SQR3: u32 = 0x34;
    pub const JSQR: u32 = 0x38;
    pub const JDR1: u32 = 0x3c;
    pub const DR: u32 = 0x4c;
}

const ADON: u32 = 0;
const CAL: u32 = 2;
const RSTCAL: u32 = 3;
const DMA: u32 = 8;
const EXTTRIG: u32 = 20;
const SWSTART: u32 = 22;
const JEXTTRIG: u32 = 15;
const JSWSTART: u32 = 21;
const TSVREFE: u32 = 23;
const SCAN: u32 = 8;
const EOC: u32 = 1 << 1;
const STRT: u32 = 1 << 4;
const JEOC: u32 = 1 << 2;
const JSTRT: u32 = 1 << 3;

/// The channel of the internal reference voltage (11.10).
const VREFINT: u32 = 17;
/// The shortest time to sample it (DS5319, table of the embedded internal reference voltage, largest value).
const VREFINT_SAMPLING: Ticks = TICKS_PER_SECOND / 1_000_000 * 171 / 10;

/// EXTSEL of TIM3's trigger output (11.7, table of external triggers for regular channels).
const TIM3_TRGO: u32 = 0b100;
/// JEXTSEL of channel 1 of TIM2 (11.7, table of external triggers for injected channels).
const TIM2_CC1: u32 = 0b011;
/// EXTSEL of SWSTART, and JEXTSEL of JSWSTART.
const SOFTWARE: u32 = 0b111;

/// Time from power-up until conversions are exact (DS5319, table of ADC characteristics).
const STABILISATION: Ticks = microseconds(1);
/// The highest clock (11.1).
const HIGHEST_CLOCK: u64 = 14_000_000;

/// Cycles from a trigger to the beginning of the sampling (DS5319, table of ADC characteristics, t_latr: 3 at the most).
pub const TRIGGER_LATENCY: Ticks = 3;

/// Half cycles for sampling, by SMPx (11.12.4).
const SAMPLING: [Ticks; 8] = [3, 15, 27, 57, 83, 111, 143, 479];
/// Half cycles for converting a sample (11.6).
const CONVERTING: Ticks = 25;
/// Cycles of a calibration (DS5319) and of resetting it (not stated; some).
const CALIBRATION: Ticks = 83;
const CALIBRATION_RESET: Ticks = 2;

/// The request of an ADC event to the chip.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Event {
    None,
    /// The input of this channel is held now, after it was sampled for this time, for conversion `index` of the
    /// sequence: [`Adc::hold`] takes its code.
    Hold {
        channel: u32,
        index: u32,
        sampled: Ticks,
    },
    /// A conversion is done, and DMA is asked for its result.
    DmaRequest,
}

/// A sequence of conversions.
#[derive(Clone, Copy, Debug)]
struct Scan {
    /// Number of the conversion in the sequence.
    index: u32,
    channel: u32,
    injected: bool,
    start: Ticks,
    held: Ticks,
    done: Ticks,
    code: Option<u16>,
}

#[derive(Debug, Default)]
pub struct Adc {
    /// Ticks of one cycle of the ADC's clock.
    clock: Ticks,
    sr: u32,
    cr1: u32,
    cr2: u32,
    smpr: [u32; 2],
    /// HTR and LTR: kept, not used.
    watchdog: [u32; 2],
    sqr: [u32; 3],
    jsqr: u32,
    jdr: u32,
    dr: u32,
    powered_since: Ticks,
    calibrated: bool,
    /// End of the present calibration, or of its reset.
    calibrates_until: Ticks,
    scan: Option<Scan>,
}

impl Adc {
    /// An ADC out of reset, on a clock of `clock` ticks.
    pub fn new(clock: Ticks) -> Self {
        Self {
            clock,
            watchdog: [0xfff, 0],
            ..Self::default()
        }
    }

    /// The clock is `clock` ticks from now on.
    pub fn set_clock(&mut self, clock: Ticks) {
        self.clock = clock;
    }

    /// Channel of conversion `index` of the sequence (11.12.9-11.12.11).
    fn channel(&self, index: u32) -> u32 {
        let [_, sqr2, sqr3] = self.sqr;
        let register = if index < 6 { sqr3 } else { sqr2 };
        field(register, index % 6 * 5, 5)
    }

    /// Conversions in the sequence: without SCAN only the first (11.3.8).
    fn length(&self) -> u32 {
        if bit(self.cr1, SCAN) {
            field(self.sqr[0], 20, 4) + 1
        } else {
            1
        }
    }

    fn sampling(&self, channel: u32) -> Ticks {
        let [smpr1, smpr2] = self.smpr;
        let register = if channel < 10 { smpr2 } else { smpr1 };
        SAMPLING[field(register, channel % 10 * 3, 3) as usize]
    }

    fn begin(&mut self, index: u32, start: Ticks) {
        self.convert(index, self.channel(index), false, start);
    }

    fn convert(&mut self, index: u32, channel: u32, injected: bool, start: Ticks) {
        let held = start + self.sampling(channel) * self.clock / 2;
        self.scan = Some(Scan {
            index,
            channel,
            injected,
            start,
            held,
            done: held + CONVERTING * self.clock / 2,
            code: None,
        });
    }

    /// The trigger output of TIM3 fired; the ADC is `late` to hear it.
    pub fn trigger_by_tim3(&mut self, late: Ticks, m: &mut Moment<'_>) {
        let listens = bit(self.cr2, EXTTRIG) && field(self.cr2, 17, 3) == TIM3_TRGO;
        if listens && bit(self.cr2, ADON) {
            self.start(late, m);
        }
    }

    /// The reference of channel 1 of TIM2 rose.
    pub fn trigger_by_tim2_channel_1(&mut self, m: &mut Moment<'_>) {
        let listens = bit(self.cr2, JEXTTRIG) && field(self.cr2, 12, 3) == TIM2_CC1;
        if listens && bit(self.cr2, ADON) {
            self.start_injected(m);
        }
    }

    fn start(&mut self, late: Ticks, m: &mut Moment<'_>) {
        if self.scan.is_some() {
            m.report(Irregularity::TriggerWhileBusy);
            return;
        }
        self.check_state(m);
        let long = bit(self.cr1, SCAN) && self.length() > 12;
        m.not_modelled(long, "a sequence of more than twelve");
        self.sr |= STRT;
        self.begin(0, m.now + late + TRIGGER_LATENCY * self.clock);
    }

    /// Begins the injected conversion (11.3.9): with JL = 0 it is that of JSQ4 (11.12.12).
    fn start_injected(&mut self, m: &mut Moment<'_>) {
        m.not_modelled(
            self.scan.is_some(),
            "an injected conversion within a sequence",
        );
        m.not_modelled(
            field(self.jsqr, 20, 2) != 0,
            "more than one injected conversion",
        );
        if self.scan.is_some() {
            return;
        }
        self.check_state(m);
        let channel = field(self.jsqr, 15, 5);
        if channel == VREFINT {
            let off = !bit(self.cr2, TSVREFE);
            m.against_manual(off, "the reference voltage without TSVREFE (11.10)");
            let short = self.sampling(channel) * self.clock / 2 < VREFINT_SAMPLING;
            m.against_manual(short, "the reference voltage sampled too shortly (11.10)");
        }
        self.sr |= JSTRT;
        self.convert(0, channel, true, m.now + TRIGGER_LATENCY * self.clock);
    }

    fn check_state(&self, m: &mut Moment<'_>) {
        let early = m.now < self.powered_since + STABILISATION;
        m.against_manual(early, "a conversion within tSTAB (11.3.1)");
        let busy = !self.calibrated || m.now < self.calibrates_until;
        m.against_manual(busy, "a conversion uncalibrated (11.4)");
        let fast = TICKS_PER_SECOND > HIGHEST_CLOCK * self.clock;
        m.against_manual(fast, "an ADC clock above 14 MHz (11.1)");
    }

    /// The time of the ADC's next event.
    pub fn next_event(&self) -> Option<Ticks> {
        self.scan.map(|scan| match scan.code {
            None => scan.held,
            Some(_) => scan.done,
        })
    }

    /// Handles the event at `m.now`.
    pub fn advance(&mut self, m: &mut Moment<'_>) -> Event {
        let Some(scan) = self.scan.filter(|_| self.next_event() == Some(m.now)) else {
            return Event::None;
        };
        let Some(code) = scan.code else {
            return Event::Hold {
                channel: scan.channel,
                index: scan.index,
                sampled: scan.held - scan.start,
            };
        };
        if scan.injected {
            self.scan = None;
            self.jdr = u32::from(code);
            self.sr |= JEOC;
            return Event::None;
        }
        m.record.conversion(Conversion {
            start: scan.start,
            held: scan.held,
            code,
        });
        let lost = self.sr & EOC != 0 && !bit(self.cr2, DMA);
        m.against_manual(lost, "a result nobody read (11.12.1)");
        self.dr = u32::from(code) << if bit(self.cr2, 11) { 4 } else { 0 };
        if scan.index + 1 < self.length() {
            self.begin(scan.index + 1, scan.done);
        } else {
            // 11.12.1: at the end of the group.
            self.scan = None;
            self.sr |= EOC;
        }
        // 11.3.8: with DMA, after each conversion.
        if bit(self.cr2, DMA) {
            Event::DmaRequest
        } else {
            Event::None
        }
    }

    /// Gives the code of the input that [`Event::Hold`] asked for.
    pub fn hold(&mut self, code: u16) {
        if let Some(scan) = &mut self.scan {
            scan.code = Some(code);
        }
    }

    /// Reads the data register, as the DMA does (11.12.14): clears EOC.
    pub fn read_data(&mut self) -> u32 {
        self.sr &= !EOC;
        self.dr
    }

    /// Whether the ADC asks for its interrupt.
    pub fn interrupt(&self) -> bool {
        self.sr & EOC != 0 && bit(self.cr1, 5)
    }

    pub fn read(&mut self, offset: u32, now: Ticks) -> Option<u32> {
        Some(match offset {
            offset::SR => self.sr,
            offset::CR1 => self.cr1,
            offset::CR2 => {
                // CAL and RSTCAL are cleared by the hardware when it is done (11.12.3).
                if now >= self.calibrates_until {
                    self.cr2 &= !(1 << CAL | 1 << RSTCAL);
                }
                self.cr2
            }
            offset::SMPR1 | offset::SMPR2 => self.smpr[usize::from(offset == offset::SMPR2)],
            0x14..offset::HTR | 0x40..offset::DR => 0,
            offset::HTR | 0x28 => self.watchdog[usize::from(offset == 0x28)],
            offset::SQR1..=offset::SQR3 => self.sqr[(offset - offset::SQR1) as usize / 4],
            offset::JSQR => self.jsqr,
            offset::JDR1 => self.jdr,
            offset::DR => self.read_data(),
            _ => return None,
        })
    }

    pub fn write(&mut self, offset: u32, value: u32, m: &mut Moment<'_>) -> Option<()> {
        match offset {
            offset::SR => self.sr &= value | !0x1f,
            offset::CR1 => {
                let more = value & !(1 << SCAN | 1 << 5) != 0;
                m.not_modelled(more, "more of the ADC than scans (CR1)");
                self.cr1 = value;
            }
            offset::CR2 => self.write_cr2(value, m),
            offset::SMPR1 | offset::SMPR2 => {
                self.smpr[usize::from(offset == offset::SMPR2)] = value;
            }
            offset::HTR | 0x28 => self.watchdog[usize::from(offset == 0x28)] = value & 0xfff,
            offset::SQR1..=offset::SQR3 => {
                let busy = self.scan.is_some();
                m.against_manual(busy, "the sequence was changed in a conversion");
                self.sqr[(offset - offset::SQR1) as usize / 4] = value;
            }
            0x14..offset::HTR => m.not_modelled(true, "offsets of injected conversions"),
            offset::JSQR => self.jsqr = value,
            offset::JDR1..=offset::DR => {}
            _ => return None,
        }
        Some(())
    }

    /// 11.3.1 and 11.12.3: ADON powers the ADC up. Written again without another change of the
    /// register, it starts a conversion.
    fn write_cr2(&mut self, value: u32, m: &mut Moment<'_>) {
        let before = self.read(offset::CR2, m.now).unwrap_or_default();
        let was_on = bit(before, ADON);
        m.not_modelled(bit(value, 1), "continuous conversions");
        let other = !matches!(field(value, 12, 3), TIM2_CC1 | SOFTWARE);
        m.not_modelled(
            bit(value, JEXTTRIG) && other,
            "this trigger of injected conversions",
        );
        let source = field(value, 17, 3);
        let other = bit(value, EXTTRIG) && !matches!(source, TIM3_TRGO | SOFTWARE);
        m.not_modelled(other, "this trigger of the ADC");
        // Cleared when the conversion starts.
        self.cr2 = value & !(1 << SWSTART | 1 << JSWSTART);
        if bit(value, ADON) && !was_on {
            self.powered_since = m.now;
        }
        if !bit(value, ADON) {
            (self.scan, self.calibrated) = (None, self.calibrated && was_on);
            return;
        }
        let begins = |n: u32| bit(value, n) && !bit(before, n);
        if begins(RSTCAL) || begins(CAL) {
            let early = !was_on || m.now < self.powered_since + 2 * self.clock;
            m.against_manual(early, "calibrated before two cycles on (11.4)");
            self.calibrated = begins(CAL);
            let cycles = if self.calibrated {
                CALIBRATION
            } else {
                CALIBRATION_RESET
            };
            self.calibrates_until = m.now + cycles * self.clock;
        }
        let by_adon = was_on && value == before;
        let by_software = bit(value, SWSTART) && bit(value, EXTTRIG) && source == SOFTWARE;
        let injects = bit(value, JEXTTRIG) && field(value, 12, 3) == SOFTWARE;
        if bit(value, JSWSTART) && injects {
            self.start_injected(m);
        }
        if by_adon || by_software {
            m.report(Irregularity::StartedBySoftware);
            self.start(0, m);
        }
    }
}

#[cfg(test)]
mod tests;
