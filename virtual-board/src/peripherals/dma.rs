//! The DMA controller DMA1 (RM0008 chapter 13): from a peripheral to memory.

use super::{Moment, bit, field};
use crate::record::Irregularity;

/// Channels of DMA1.
pub const CHANNELS: usize = 7;

const EN: u32 = 0;
const TCIE: u32 = 1;
const HTIE: u32 = 2;
const DIR: u32 = 4;
const CIRC: u32 = 5;
const PINC: u32 = 6;
const MINC: u32 = 7;
const MEM2MEM: u32 = 14;

/// Flags of one channel, four bits each (13.4.1).
const GIF: u32 = 1 << 0;
const TCIF: u32 = 1 << 1;
const HTIF: u32 = 1 << 2;
const TEIF: u32 = 1 << 3;

/// One transfer, from a peripheral's register to memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Transfer {
    pub peripheral: u32,
    pub memory: u32,
    pub bytes: u32,
}

#[derive(Clone, Copy, Debug, Default)]
struct Channel {
    ccr: u32,
    cndtr: u32,
    cpar: u32,
    cmar: u32,
    /// CNDTR when the channel was enabled: the length of a round.
    reload: u32,
}

#[derive(Debug, Default)]
pub struct Dma {
    isr: u32,
    channels: [Channel; CHANNELS],
}

impl Dma {
    /// Whether channel `number` (1 to 7) asks for its interrupt.
    pub fn interrupt(&self, number: u32) -> bool {
        let flags = field(self.isr, 4 * (number - 1), 4);
        self.channels
            .get(number as usize - 1)
            // TCIE, HTIE and TEIE lie in the same order as their flags.
            .is_some_and(|channel| flags & channel.ccr & (TCIF | HTIF | TEIF) != 0)
    }

    /// A peripheral asks channel `number` (1 to 7) for a transfer (13.3.2). `None` where the channel
    /// is off or its round is over.
    pub fn request(&mut self, number: u8, m: &mut Moment<'_>) -> Option<Transfer> {
        let shift = 4 * u32::from(number - 1);
        let channel = self.channels.get_mut(usize::from(number) - 1)?;
        if !bit(channel.ccr, EN) || channel.cndtr == 0 {
            return None;
        }
        let bytes = 1 << field(channel.ccr, 10, 2);
        let passed = channel.reload - channel.cndtr;
        let steps = if bit(channel.ccr, MINC) { passed } else { 0 };
        let transfer = Transfer {
            peripheral: channel.cpar,
            memory: channel.cmar + steps * bytes,
            bytes,
        };
        channel.cndtr -= 1;
        // 13.3.3: half of the round, and its end.
        let mut flags = 0;
        if channel.cndtr == channel.reload / 2 {
            flags |= HTIF;
        }
        if channel.cndtr == 0 {
            flags |= TCIF;
            if bit(channel.ccr, CIRC) {
                channel.cndtr = channel.reload;
            }
        }
        // A flag that is set again was not noticed in time.
        let watched = bit(channel.ccr, TCIE) || bit(channel.ccr, HTIE);
        let late = watched && field(self.isr, shift, 4) & flags != 0;
        m.report_if(late, Irregularity::DmaOverrun(number));
        if flags != 0 {
            self.isr |= (flags | GIF) << shift;
        }
        Some(transfer)
    }

    /// The transfer of channel `number` failed: the channel is switched off (13.3.4).
    pub fn fail(&mut self, number: u8) {
        self.isr |= (TEIF | GIF) << (4 * u32::from(number - 1));
        if let Some(channel) = self.channels.get_mut(usize::from(number) - 1) {
            channel.ccr &= !(1 << EN);
        }
    }

    pub fn read(&self, offset: u32) -> Option<u32> {
        match offset {
            0x00 => Some(self.isr),
            0x04 => Some(0),
            _ => {
                let (index, register) = locate(offset)?;
                let channel = self.channels.get(index)?;
                Some(match register {
                    0 => channel.ccr,
                    1 => channel.cndtr,
                    2 => channel.cpar,
                    _ => channel.cmar,
                })
            }
        }
    }

    pub fn write(&mut self, offset: u32, value: u32, m: &mut Moment<'_>) -> Option<()> {
        match offset {
            0x00 => {}
            0x04 => {
                // 13.4.2: CGIF clears all four flags of its channel.
                let all = (0..CHANNELS as u32)
                    .filter(|n| bit(value, 4 * n))
                    .fold(0, |bits, n| bits | 0xf << (4 * n));
                self.isr &= !(value & 0x0fff_ffff | all);
            }
            _ => {
                let (index, register) = locate(offset)?;
                let channel = self.channels.get_mut(index)?;
                if register == 0 {
                    channel.write_ccr(value & 0x7fff, index, m);
                } else if bit(channel.ccr, EN) {
                    m.against_manual(true, "a DMA channel written while on (13.4.4-13.4.6)");
                } else {
                    match register {
                        1 => channel.cndtr = value & 0xffff,
                        2 => channel.cpar = value,
                        _ => channel.cmar = value,
                    }
                }
            }
        }
        Some(())
    }
}

impl Channel {
    fn write_ccr(&mut self, value: u32, index: usize, m: &mut Moment<'_>) {
        if bit(value, EN) && !bit(self.ccr, EN) {
            self.reload = self.cndtr;
            m.not_modelled(index != 0, "requests to another DMA channel than 1");
            let other = bit(value, DIR) || bit(value, PINC) || bit(value, MEM2MEM);
            m.not_modelled(other, "DMA other than from a register to memory");
            let (register, memory) = (field(value, 8, 2), field(value, 10, 2));
            m.not_modelled(
                register != memory,
                "DMA between widths that differ (13.3.4)",
            );
            let size = 1 << memory;
            let aligned = self.cpar.is_multiple_of(size) && self.cmar.is_multiple_of(size);
            m.against_manual(
                !aligned || size > 4,
                "DMA at an address or of a width that is none (13.4)",
            );
        }
        self.ccr = value;
    }
}

/// Channel index and register (CCR, CNDTR, CPAR, CMAR) at `offset` (13.4.7).
fn locate(offset: u32) -> Option<(usize, u32)> {
    let in_channels = offset.checked_sub(0x08)?;
    let (index, register) = (in_channels / 20, in_channels % 20 / 4);
    (index < CHANNELS as u32 && register < 4).then_some((index as usize, register))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::peripherals::testing::Bench;

    /// Circular, memory increment, 16 bits, both interrupts.
    const RING: u32 = 1 << 10 | 1 << 8 | 1 << MINC | 1 << CIRC | 1 << HTIE | 1 << TCIE;

    fn ring(length: u32) -> (Dma, Bench) {
        let (mut dma, mut bench) = (Dma::default(), Bench::default());
        for (offset, value) in [
            (0x0c, length),
            (0x10, 0x4001_244c),
            (0x14, 0x2000_0100),
            (0x08, RING | 1),
        ] {
            dma.write(offset, value, &mut bench.at(0));
        }
        (dma, bench)
    }

    #[test]
    fn a_ring_goes_round_and_says_when_a_half_is_full() {
        let (mut dma, mut bench) = ring(4);
        for (n, flags) in [(0, 0), (1, HTIF), (2, 0), (3, TCIF), (0, 0), (1, HTIF)] {
            let transfer = dma.request(1, &mut bench.at(0)).unwrap();
            let expected = Transfer {
                peripheral: 0x4001_244c,
                memory: 0x2000_0100 + 2 * n,
                bytes: 2,
            };
            assert_eq!(transfer, expected);
            assert_eq!(dma.read(0x00).unwrap() & !GIF, flags);
            assert_eq!(dma.interrupt(1), flags != 0);
            dma.write(0x04, flags | GIF, &mut bench.at(0));
        }
        assert_eq!(bench.reported(), []);
    }

    #[test]
    fn a_half_that_nobody_took_is_an_overrun() {
        let (mut dma, mut bench) = ring(4);
        for _ in 0..6 {
            dma.request(1, &mut bench.at(0));
        }
        assert_eq!(bench.reported(), [Irregularity::DmaOverrun(1)]);
    }

    #[test]
    fn widths_and_addresses_must_fit() {
        for (ccr, memory, good) in [
            (RING, 0x2000_0100, true),
            (RING, 0x2000_0101, false),
            (RING & !(1 << 8), 0x2000_0100, false),
            (RING | 3 << 10 | 3 << 8, 0x2000_0100, false),
        ] {
            let (mut dma, mut bench) = (Dma::default(), Bench::default());
            dma.write(0x10, 0x4001_244c, &mut bench.at(0));
            dma.write(0x14, memory, &mut bench.at(0));
            dma.write(0x08, ccr | 1, &mut bench.at(0));
            assert_eq!(bench.reported().is_empty(), good, "{ccr:#x} {memory:#x}");
        }
    }

    #[test]
    fn a_single_round_ends() {
        let (mut dma, mut bench) = (Dma::default(), Bench::default());
        dma.write(0x0c, 1, &mut bench.at(0));
        dma.write(0x08, 1, &mut bench.at(0));
        assert!(dma.request(1, &mut bench.at(0)).is_some());
        assert_eq!(dma.read(0x0c), Some(0));
        assert!(dma.request(1, &mut bench.at(0)).is_none());
    }

    #[test]
    fn clearing_the_global_flag_clears_all() {
        let (mut dma, mut bench) = ring(2);
        dma.request(1, &mut bench.at(0));
        dma.request(1, &mut bench.at(0));
        assert_eq!(dma.read(0x00), Some(GIF | HTIF | TCIF));
        dma.write(0x04, TCIF, &mut bench.at(0));
        assert_eq!(dma.read(0x00), Some(GIF | HTIF));
        dma.write(0x04, GIF, &mut bench.at(0));
        assert_eq!(dma.read(0x00), Some(0));
    }

    #[test]
    fn a_channel_that_is_on_keeps_its_addresses() {
        let (mut dma, mut bench) = ring(4);
        dma.write(0x14, 0x2000_0000, &mut bench.at(0));
        assert_eq!(dma.read(0x14), Some(0x2000_0100));
        assert_eq!(bench.reported().len(), 1);
    }

    #[test]
    fn an_error_switches_the_channel_off() {
        let (mut dma, mut bench) = ring(4);
        dma.fail(1);
        assert!(dma.request(1, &mut bench.at(0)).is_none());
        assert_eq!(dma.read(0x00), Some(GIF | TEIF));
    }
}
