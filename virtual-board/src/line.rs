//! The serial line between host and board, 115200 baud, and its disturbances.

use crate::fault::{Direction, Disturbance, Fault};
use crate::peripherals::usart::FRAME_BITS;
use crate::time::{TICKS_PER_SECOND, Ticks, milliseconds};
use rand::{Rng, RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::collections::VecDeque;

/// Length of the host's bits.
pub const BIT: Ticks = TICKS_PER_SECOND / 115_200;

/// Largest difference of the bit rates (percent): beyond it, the last bits of a byte are sampled in their neighbours (RM0008 27.3.5, table of the receiver's tolerance).
const TOLERANCE: Ticks = 3;

/// The longest time that a byte is late.
const LATEST: Ticks = milliseconds(500);

/// The line.
#[derive(Debug)]
pub struct Line {
    disturbances: Vec<(Option<Direction>, Disturbance, f64)>,
    random: ChaCha8Rng,
    silent_from: Ticks,
    /// Bits of the host's bytes.
    frame_bits: Ticks,
    to_board: VecDeque<u8>,
    /// When the first byte of `to_board` is complete.
    arrives: Option<Ticks>,
    to_host: VecDeque<u8>,
    /// Until then the host receives nothing.
    to_host_from: Ticks,
}

impl Line {
    /// A line with those of `faults` that happen on it; `seed` chooses which bytes they hit.
    pub fn new(faults: &[Fault], seed: u64) -> Self {
        let mut line = Self {
            disturbances: Vec::new(),
            random: ChaCha8Rng::seed_from_u64(seed),
            silent_from: Ticks::MAX,
            frame_bits: FRAME_BITS,
            to_board: VecDeque::new(),
            arrives: None,
            to_host: VecDeque::new(),
            to_host_from: 0,
        };
        for fault in faults {
            match *fault {
                Fault::HostSilent(from) => line.silent_from = from,
                Fault::Line {
                    direction,
                    disturbance,
                    probability,
                } => line
                    .disturbances
                    .push((direction, disturbance, probability)),
                _ => {}
            }
        }
        line
    }

    /// The host's bytes have so many bits from now on.
    pub fn set_frame_bits(&mut self, bits: Ticks) {
        self.frame_bits = bits;
    }

    /// The host sends bytes; they take their time.
    pub fn host_writes(&mut self, bytes: &[u8], now: Ticks) {
        if now >= self.silent_from {
            return;
        }
        let mut late = 0;
        for &byte in bytes {
            let passed = self.disturb(byte, Direction::ToBoard, &mut late);
            self.to_board.extend(passed);
        }
        if self.arrives.is_none() && !self.to_board.is_empty() {
            self.arrives = Some(now + self.frame_bits * BIT);
        }
        self.arrives = self.arrives.map(|at| at + late);
    }

    /// When the next byte is complete at the board.
    pub fn next_event(&self) -> Option<Ticks> {
        self.arrives
    }

    /// The byte that is complete at the board at `now`, for a receiver with this bit time; and
    /// whether it came damaged.
    pub fn arrive(&mut self, now: Ticks, bit_time: Ticks) -> Option<(u8, bool)> {
        self.arrives.take_if(|at| *at == now)?;
        let byte = self.to_board.pop_front()?;
        if !self.to_board.is_empty() {
            self.arrives = Some(now + self.frame_bits * BIT);
        }
        Some(through(byte, bit_time))
    }

    /// A byte from the board, sent with this bit time, is complete at the host.
    pub fn board_writes(&mut self, byte: u8, bit_time: Ticks, now: Ticks) {
        let (byte, _) = through(byte, bit_time);
        let mut late = 0;
        let passed = self.disturb(byte, Direction::ToHost, &mut late);
        self.to_host.extend(passed);
        if late > 0 {
            self.to_host_from = now + late;
        }
    }

    /// Copies the bytes received at the host; returns how many.
    pub fn host_reads(&mut self, buffer: &mut [u8], now: Ticks) -> usize {
        if now < self.to_host_from {
            return 0;
        }
        let count = buffer.len().min(self.to_host.len());
        for (slot, byte) in buffer.iter_mut().zip(self.to_host.drain(..count)) {
            *slot = byte;
        }
        count
    }

    /// A byte after its disturbance; how late it is, in `late`.
    fn disturb(
        &mut self,
        byte: u8,
        direction: Direction,
        late: &mut Ticks,
    ) -> impl Iterator<Item = u8> + use<> {
        let (mut before, mut byte) = (None, Some(byte));
        for (only, disturbance, probability) in &self.disturbances {
            let hit = self.random.random_bool(*probability);
            if !hit || only.is_some_and(|only| only != direction) {
                continue;
            }
            match disturbance {
                Disturbance::Flip => {
                    byte = byte.map(|byte| byte ^ 1 << self.random.random_range(0..8));
                }
                Disturbance::Drop => byte = None,
                Disturbance::Inject => before = Some(self.random.next_u32() as u8),
                Disturbance::Late => *late = self.random.random_range(0..LATEST),
            }
        }
        before.into_iter().chain(byte)
    }
}

/// A byte between ends of different bit rates. It is damaged if they differ too much, because its last bits and its
/// stop bit are sampled in other bits.
fn through(byte: u8, bit_time: Ticks) -> (u8, bool) {
    let damaged = bit_time.abs_diff(BIT) * 100 > BIT * TOLERANCE;
    (if damaged { byte ^ 0xe0 } else { byte }, damaged)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn send(line: &mut Line, bytes: &[u8]) -> Vec<(Ticks, u8)> {
        line.host_writes(bytes, 0);
        let mut arrived = Vec::new();
        while let Some(at) = line.next_event() {
            arrived.extend(line.arrive(at, BIT).map(|(byte, _)| (at, byte)));
        }
        arrived
    }

    fn with(faults: &[&str]) -> Line {
        let faults: Vec<Fault> = faults.iter().map(|f| f.parse().unwrap()).collect();
        Line::new(&faults, 1)
    }

    #[test]
    fn bytes_arrive_ten_bits_apart() {
        let arrived = send(&mut with(&[]), &[1, 2, 3]);
        assert_eq!(arrived, [(10 * BIT, 1), (20 * BIT, 2), (30 * BIT, 3)]);
    }

    #[test]
    fn another_baud_rate_damages() {
        let mut line = with(&[]);
        for (bit_time, good) in [
            (BIT, true),
            (BIT * 103 / 100, true),
            (BIT * 104 / 100, false),
        ] {
            line.board_writes(0x55, bit_time, 0);
            let mut byte = [0];
            line.host_reads(&mut byte, 0);
            assert_eq!(byte == [0x55], good, "{bit_time}");
        }
    }

    /// About a tenth of 10 000 bytes; 5 standard deviations of a binomial are 150.
    #[test]
    fn disturbances_hit_as_often_as_they_should_and_their_direction_only() {
        let sent = [0x3c; 10_000];
        for (fault, length, intact) in [
            ("to-board-flip:0.1", 10_000, 9_000),
            ("to-board-drop:0.1", 9_000, 9_000),
            ("to-board-inject:0.1", 11_000, 10_000),
            ("to-host-drop:0.1", 10_000, 10_000),
        ] {
            let arrived = send(&mut with(&[fault]), &sent);
            let good = arrived.iter().filter(|(_, byte)| *byte == 0x3c).count();
            assert!(arrived.len().abs_diff(length) < 150, "{fault}");
            // An injected byte may be 0x3c as well: 4 of 1000.
            assert!(good.abs_diff(intact) < 150, "{fault}");
        }
    }

    #[test]
    fn what_is_late_comes_all_the_same() {
        let mut line = with(&["late:1"]);
        line.board_writes(7, BIT, 0);
        let mut byte = [0];
        assert_eq!(line.host_reads(&mut byte, 0), 0);
        assert_eq!(line.host_reads(&mut byte, LATEST), 1);
        let arrived = send(&mut line, &[1]);
        assert!(arrived[0].0 > 10 * BIT && arrived[0].1 == 1);
    }

    #[test]
    fn a_silent_host_is_not_heard() {
        let mut line = with(&["host-silent@1"]);
        line.host_writes(&[1], TICKS_PER_SECOND);
        assert_eq!(line.next_event(), None);
    }
}
