//! The serial port USART1 (RM0008 chapter 27): eight bits, no parity, by interrupt.

use super::{Moment, bit};
use crate::record::Irregularity;
use crate::time::Ticks;

/// Registers by their offsets (27.6.8).
mod offset {
    pub const SR: u32 = 0x00;
    pub const DR: u32 = 0x04;
    pub const BRR: u32 = 0x08;
    pub const CR1: u32 = 0x0c;
    pub const CR2: u32 = 0x10;
    pub const CR3: u32 = 0x14;
    pub const GTPR: u32 = 0x18;
}

/// Flags (27.6.1).
const FE: u32 = 1 << 1;
const ORE: u32 = 1 << 3;
const IDLE: u32 = 1 << 4;
const RXNE: u32 = 1 << 5;
const TC: u32 = 1 << 6;
const TXE: u32 = 1 << 7;
/// Cleared by reading SR, then DR: ORE, NE, FE, PE, IDLE.
const CLEARED_BY_DATA: u32 = 0x1f;

const RE: u32 = 2;
const TE: u32 = 3;
const UE: u32 = 13;

/// Bits of a frame: start, eight, stop (27.3.1).
pub const FRAME_BITS: Ticks = 10;

#[derive(Debug, Default)]
pub struct Usart {
    /// Ticks of one cycle of the USART's clock.
    clock: Ticks,
    sr: u32,
    cr1: u32,
    brr: u32,
    received: u8,
    /// SR was read, so reading DR clears the errors.
    sr_read: bool,
    /// The byte in the data register.
    waiting: Option<u8>,
    /// Content of the shift register, and the time at which it is out; without a byte it is the idle frame
    /// after the transmitter is enabled.
    shifting: Option<(Option<u8>, Ticks)>,
    /// When the line will have been idle for a frame.
    idle_at: Option<Ticks>,
}

impl Usart {
    /// A USART out of reset, on a clock of `clock` ticks.
    pub fn new(clock: Ticks) -> Self {
        Self {
            clock,
            sr: TXE | TC,
            ..Self::default()
        }
    }

    /// The clock is `clock` ticks from now on.
    pub fn set_clock(&mut self, clock: Ticks) {
        self.clock = clock;
    }

    /// Length of a bit. 27.3.4: fCK / baud = 16 USARTDIV, the content of BRR.
    pub fn bit_time(&self) -> Ticks {
        self.clock * Ticks::from(self.brr)
    }

    fn is_on(&self, part: u32) -> bool {
        bit(self.cr1, UE) && bit(self.cr1, part)
    }

    /// Whether the receiver is on.
    pub fn listens(&self) -> bool {
        self.is_on(RE)
    }

    /// The time of the next event.
    pub fn next_event(&self) -> Option<Ticks> {
        let sent = self.shifting.map(|(_, at)| at);
        [sent, self.idle_at].into_iter().flatten().min()
    }

    /// Handles the event at `now`; returns the byte that has left, if any.
    pub fn advance(&mut self, now: Ticks) -> Option<u8> {
        if self.idle_at == Some(now) {
            self.idle_at = None;
            self.sr |= IDLE;
        }
        let (byte, _) = self.shifting.take_if(|(_, at)| *at == now)?;
        match self.waiting.take() {
            Some(next) => self.shift(Some(next), now),
            // 27.3.2: the last one is complete.
            None => self.sr |= TC,
        }
        byte
    }

    fn shift(&mut self, byte: Option<u8>, now: Ticks) {
        self.shifting = Some((byte, now + FRAME_BITS * self.bit_time()));
        self.sr |= TXE;
    }

    /// A byte from the line is complete; `damaged` where its stop bit was not one.
    pub fn receive(&mut self, byte: u8, damaged: bool, m: &mut Moment<'_>) {
        if !self.is_on(RE) {
            return;
        }
        self.idle_at = Some(m.now + FRAME_BITS * self.bit_time());
        if self.sr & RXNE != 0 {
            // 27.6.1: the byte before stays, this one is lost.
            self.sr |= ORE;
            m.report(Irregularity::ReceiverOverrun);
            return;
        }
        self.received = byte;
        self.sr |= RXNE | if damaged { FE } else { 0 };
    }

    /// Whether the USART asks for its interrupt (27.4): each enable in CR1 has its flags.
    pub fn interrupt(&self) -> bool {
        [(4, IDLE), (5, RXNE | ORE), (6, TC), (7, TXE)]
            .into_iter()
            .any(|(enable, flags)| bit(self.cr1, enable) && self.sr & flags != 0)
    }

    pub fn read(&mut self, offset: u32) -> Option<u32> {
        Some(match offset {
            offset::SR => {
                self.sr_read = true;
                self.sr
            }
            offset::DR => {
                self.sr &= !RXNE;
                if std::mem::take(&mut self.sr_read) {
                    self.sr &= !CLEARED_BY_DATA;
                }
                u32::from(self.received)
            }
            offset::BRR => self.brr,
            offset::CR1 => self.cr1,
            offset::CR2 | offset::CR3 | offset::GTPR => 0,
            _ => return None,
        })
    }

    pub fn write(&mut self, offset: u32, value: u32, m: &mut Moment<'_>) -> Option<()> {
        match offset {
            // CTS, LBD, TC and RXNE are cleared by 0 (27.6.1).
            offset::SR => self.sr &= value | !(TC | RXNE),
            offset::DR => self.send(value as u8, m),
            offset::BRR => self.brr = value & 0xffff,
            offset::CR1 => {
                let more = value & 0x1f03 != 0;
                m.not_modelled(more, "nine bits, parity, break or mute (CR1)");
                let was_on = self.is_on(TE);
                self.cr1 = value & 0x3fff;
                // 27.3.2: enabling the transmitter sends an idle frame first.
                if self.is_on(TE) && !was_on && self.brr != 0 {
                    self.sr &= !TC;
                    self.shift(None, m.now);
                }
            }
            offset::CR2 => m.not_modelled(value != 0, "other stop bits, clock, LIN"),
            offset::CR3 => m.not_modelled(value != 0, "DMA, flow control or IrDA of the USART"),
            offset::GTPR => m.not_modelled(value != 0, "smart cards"),
            _ => return None,
        }
        Some(())
    }

    fn send(&mut self, byte: u8, m: &mut Moment<'_>) {
        let off = !self.is_on(TE) || self.brr == 0;
        m.against_manual(off, "data for a transmitter that is off (27.3.2)");
        if off {
            return;
        }
        // 27.6.1: TC is cleared by reading SR, then writing DR.
        if std::mem::take(&mut self.sr_read) {
            self.sr &= !TC;
        }
        if self.shifting.is_none() {
            self.shift(Some(byte), m.now);
        } else {
            m.against_manual(self.waiting.is_some(), "data written over data (27.3.2)");
            self.waiting = Some(byte);
            self.sr &= !TXE;
        }
    }
}

#[cfg(test)]
mod tests;
