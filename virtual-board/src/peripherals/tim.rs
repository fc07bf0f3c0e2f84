//! A general-purpose timer, TIM2 or TIM3 (RM0008 chapter 15).
//!
//! Counting up, output compare, the trigger output and the slave's trigger mode. The few bus cycles
//! that the hardware takes from a trigger to the counter's start (15.3.15) are left out: they are
//! always the same, and well below a microsecond.

use super::{Moment, bit, field};
use crate::time::Ticks;

/// Registers by their offsets (15.4.19).
mod offset {
    pub const CR1: u32 = 0x00;
    pub const CR2: u32 = 0x04;
    pub const SMCR: u32 = 0x08;
    pub const DIER: u32 = 0x0c;
    pub const SR: u32 = 0x10;
    pub const EGR: u32 = 0x14;
    pub const CCMR1: u32 = 0x18;
    pub const CCMR2: u32 = 0x1c;
    pub const CCER: u32 = 0x20;
    pub const CNT: u32 = 0x24;
    pub const PSC: u32 = 0x28;
    pub const ARR: u32 = 0x2c;
    pub const CCR1: u32 = 0x34;
    pub const CCR4: u32 = 0x40;
}

const CEN: u32 = 0;
const UDIS: u32 = 1;
const URS: u32 = 2;
const OPM: u32 = 3;
const ARPE: u32 = 7;
const UIF: u32 = 1 << 0;
const TIF: u32 = 1 << 6;
/// UIF, CC1IF to CC4IF, TIF, CC1OF to CC4OF.
const SR_BITS: u32 = 0x1e5f;

/// Values that take effect at an update event (15.3.1, 15.3.8).
#[derive(Clone, Copy, Debug, Default)]
struct Shadowed {
    prescaler: u32,
    reload: u32,
    /// One for each channel.
    compare: [u32; 4],
}

/// Whether a trigger goes out, to the timer's slaves and to the ADC.
pub type TriggerOutput = bool;

#[derive(Debug, Default)]
pub struct Tim {
    cr1: u32,
    cr2: u32,
    smcr: u32,
    dier: u32,
    sr: u32,
    ccmr: [u32; 2],
    ccer: u32,
    written: Shadowed,
    active: Shadowed,
    /// Ticks of one cycle of the timer's clock.
    clock: Ticks,
    /// The count at `since`.
    count: u32,
    since: Ticks,
    /// A debugger has stopped it (31.16.2).
    frozen: bool,
}

impl Tim {
    /// A timer out of reset, on a clock of `clock` ticks.
    pub fn new(clock: Ticks) -> Self {
        Self {
            clock,
            ..Self::default()
        }
    }

    /// Whether it counts its clock.
    fn runs(&self) -> bool {
        // 15.3.1: the counter is blocked while the reload value is null.
        bit(self.cr1, CEN) && self.active.reload != 0 && !self.counts_triggers() && !self.frozen
    }

    /// SMS = 111, external clock mode 1: the counter counts the edges of its trigger input (15.3.12).
    fn counts_triggers(&self) -> bool {
        field(self.smcr, 0, 3) == 0b111
    }

    /// Stops the counter where it is, with its outputs as they are.
    pub fn freeze(&mut self, now: Ticks) {
        self.settle(now);
        self.frozen = true;
    }

    /// Ticks of one count.
    fn step(&self) -> Ticks {
        self.clock * Ticks::from(self.active.prescaler + 1)
    }

    /// The count at `now`, which is before the next [`event`](Self::next_event).
    pub fn count(&self, now: Ticks) -> u32 {
        if self.runs() {
            self.count + ((now - self.since) / self.step()) as u32
        } else {
            self.count
        }
    }

    /// The clock is `clock` ticks from now on.
    pub fn set_clock(&mut self, clock: Ticks, now: Ticks) {
        if clock != self.clock {
            self.settle(now);
            self.clock = clock;
        }
    }

    /// Makes `now` the time of the stored count. The elapsed part of the present count is lost, as a stop, a
    /// new count or a new clock requires.
    fn settle(&mut self, now: Ticks) {
        self.count = self.count(now);
        self.since = now;
    }

    /// Where the counter starts again (15.3.2). A count set beyond the reload value first runs
    /// through all 16 bits.
    fn top(&self) -> u32 {
        if self.count > self.active.reload {
            0xffff
        } else {
            self.active.reload
        }
    }

    /// The time of the next event.
    pub fn next_event(&self) -> Option<Ticks> {
        let next = self
            .active
            .compare
            .into_iter()
            .filter(|&compare| compare > self.count && compare <= self.top())
            .chain([self.top() + 1])
            .min()?;
        let until = Ticks::from(next - self.count) * self.step();
        self.runs().then_some(self.since + until)
    }

    /// Handles the event at `now`.
    pub fn advance(&mut self, now: Ticks) -> TriggerOutput {
        if self.next_event() != Some(now) {
            return false;
        }
        let count = self.count(now);
        let overflows = count > self.top();
        self.count = if overflows { 0 } else { count };
        self.since = now;
        let mut trigger = false;
        if overflows && !bit(self.cr1, UDIS) {
            trigger = self.update();
            self.sr |= UIF;
            if bit(self.cr1, OPM) {
                self.cr1 &= !(1 << CEN);
            }
        }
        self.match_channels();
        trigger
    }

    /// Sets the flag of each channel whose compare value is reached (15.3.7).
    fn match_channels(&mut self) {
        for (channel, compare) in self.active.compare.into_iter().enumerate() {
            if compare == self.count {
                self.sr |= 1 << (channel + 1);
            }
        }
    }

    /// The update event (15.3.2): all that is preloaded takes effect.
    fn update(&mut self) -> TriggerOutput {
        self.active = self.written;
        self.master_mode() == 0b010
    }

    /// MMS (15.4.2).
    fn master_mode(&self) -> u32 {
        field(self.cr2, 4, 3)
    }

    /// A trigger comes in at the internal input `input` (ITR0 to ITR3).
    pub fn trigger(&mut self, input: u32, now: Ticks) -> TriggerOutput {
        if field(self.smcr, 4, 3) != input || self.frozen {
            return false;
        }
        match field(self.smcr, 0, 3) {
            // Trigger mode: the counter starts and is not reset (15.4.3).
            0b110 => {
                self.sr |= TIF;
                self.start(now)
            }
            0b111 => {
                self.sr |= TIF;
                self.count_one()
            }
            _ => false,
        }
    }

    /// Counts an edge of the trigger input.
    fn count_one(&mut self) -> TriggerOutput {
        if !bit(self.cr1, CEN) || self.active.reload == 0 {
            return false;
        }
        if self.count < self.top() {
            self.count += 1;
            return false;
        }
        self.count = 0;
        self.sr |= UIF;
        self.update()
    }

    fn start(&mut self, now: Ticks) -> TriggerOutput {
        let starts = !bit(self.cr1, CEN);
        if starts {
            self.cr1 |= 1 << CEN;
            self.since = now;
        }
        // MMS = 001: the trigger output is the counter's enable (15.4.2).
        starts && self.master_mode() == 0b001
    }

    /// The level of output `channel` (1 to 4) at `now`, `None` while it is not driven.
    pub fn output(&self, channel: u32, now: Ticks) -> Option<bool> {
        let enables = field(self.ccer, 4 * (channel - 1), 4);
        let below = self.count(now) < self.active.compare[channel as usize - 1];
        let reference = match self.mode(channel) {
            0b101 => true,
            0b110 => below,
            0b111 => !below,
            // Forced low. Frozen or toggling is not modelled: see `check_modes`.
            _ => false,
        };
        // CC1P inverts (15.4.9).
        bit(enables, 0).then_some(reference != bit(enables, 1))
    }

    /// OCxM of `channel` (15.4.7, 15.4.8).
    fn mode(&self, channel: u32) -> u32 {
        field(self.half(channel), 4, 3)
    }

    /// The byte of CCMR1 or CCMR2 that belongs to `channel`.
    fn half(&self, channel: u32) -> u32 {
        let [low, high] = self.ccmr;
        let register = if channel < 3 { low } else { high };
        field(register, (channel - 1) % 2 * 8, 8)
    }

    fn preloads(&self, channel: u32) -> bool {
        bit(self.half(channel), 3)
    }

    /// Whether the timer asks for its interrupt.
    pub fn interrupt(&self) -> bool {
        self.sr & self.dier & 0x5f != 0
    }

    pub fn read(&self, offset: u32, now: Ticks) -> Option<u32> {
        Some(match offset {
            offset::CR1 => self.cr1,
            offset::CR2 => self.cr2,
            offset::SMCR => self.smcr,
            offset::DIER => self.dier,
            offset::SR => self.sr,
            offset::EGR => 0,
            offset::CCMR1 => self.ccmr[0],
            offset::CCMR2 => self.ccmr[1],
            offset::CCER => self.ccer,
            offset::CNT => self.count(now),
            offset::PSC => self.written.prescaler,
            offset::ARR => self.written.reload,
            offset::CCR1..=offset::CCR4 => {
                self.written.compare[(offset - offset::CCR1) as usize / 4]
            }
            _ => return None,
        })
    }

    pub fn write(&mut self, offset: u32, value: u32, m: &mut Moment<'_>) -> Option<TriggerOutput> {
        let value = value & 0xffff;
        let mut trigger = false;
        match offset {
            offset::CR1 => trigger = self.write_cr1(value, m),
            offset::CR2 => {
                self.cr2 = value & 0xf8;
                let other = self.master_mode() > 0b010 || bit(value, 7);
                m.not_modelled(other, "this trigger output of a timer");
            }
            offset::SMCR => {
                let mode = field(value, 0, 3);
                let other = !matches!(mode, 0b000 | 0b110 | 0b111) || field(value, 8, 8) != 0;
                m.not_modelled(other, "this slave mode of a timer");
                let divided = mode == 0b111 && self.active.prescaler != 0;
                m.not_modelled(divided, "a prescaler of triggers");
                self.settle(m.now);
                self.smcr = value;
            }
            offset::DIER => {
                m.not_modelled(value & 0x7f00 != 0, "DMA by a timer");
                self.dier = value;
            }
            // Writing 0 clears a flag, writing 1 has no effect (15.4.5).
            offset::SR => self.sr &= value | !SR_BITS,
            offset::EGR => trigger = self.generate(value, m.now),
            offset::CCMR1 | offset::CCMR2 => {
                self.ccmr[usize::from(offset == offset::CCMR2)] = value;
                self.check_modes(m);
            }
            offset::CCER => self.ccer = value,
            offset::CNT => {
                self.count = value;
                self.since = m.now;
            }
            offset::PSC => self.written.prescaler = value,
            offset::ARR => self.write_reload(value, m),
            offset::CCR1..=offset::CCR4 => self.write_compare(offset, value, m),
            _ => return None,
        }
        Some(trigger)
    }

    fn write_cr1(&mut self, value: u32, m: &mut Moment<'_>) -> TriggerOutput {
        m.not_modelled(value & 0x70 != 0, "a timer that counts down");
        if !bit(value, CEN) {
            self.settle(m.now);
            self.cr1 = value;
            return false;
        }
        self.cr1 = value & !(1 << CEN) | self.cr1 & 1 << CEN;
        self.start(m.now)
    }

    /// EGR (15.4.6).
    fn generate(&mut self, value: u32, now: Ticks) -> TriggerOutput {
        self.sr |= value & 0x1e;
        if bit(value, 6) {
            self.sr |= TIF;
        }
        if !bit(value, 0) {
            return false;
        }
        self.count = 0;
        self.since = now;
        let mut trigger = false;
        if !bit(self.cr1, UDIS) {
            trigger = self.update();
            // URS: only an overflow sets the flag (15.4.1).
            if !bit(self.cr1, URS) {
                self.sr |= UIF;
            }
        }
        // MMS = 000: UG itself is the trigger output (15.4.2).
        trigger || self.master_mode() == 0b000
    }

    fn write_reload(&mut self, value: u32, m: &mut Moment<'_>) {
        self.written.reload = value;
        if !bit(self.cr1, ARPE) {
            m.not_modelled(self.runs(), "a running timer's reload value");
            self.active.reload = value;
        }
    }

    fn write_compare(&mut self, offset: u32, value: u32, m: &mut Moment<'_>) {
        let index = (offset - offset::CCR1) / 4;
        self.written.compare[index as usize] = value;
        if !self.preloads(index + 1) {
            self.active.compare[index as usize] = value;
            let drives = bit(self.cr1, CEN) && bit(self.ccer, 4 * index);
            m.against_manual(
                drives,
                "a running timer's compare value without preload: the pulse may be cut (15.3.9)",
            );
        }
    }

    fn check_modes(&self, m: &mut Moment<'_>) {
        for channel in 1..=4 {
            // CCxS: an input. OCxCE, OCxFE: clearing by ETR, and a fast enable.
            let other = self.half(channel) & 0b1000_0111 != 0;
            m.not_modelled(other, "input capture, or clearing of an output");
            let follows = matches!(self.mode(channel), 0b001..=0b011);
            m.not_modelled(follows, "an output that follows a match");
        }
    }
}

#[cfg(test)]
mod tests;
