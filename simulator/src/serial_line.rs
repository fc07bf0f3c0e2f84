//! The serial line between rig and host, in simulated time.

use crate::options::LineSpeed;
use servoid_firmware::Link;
use std::cell::RefCell;
use std::collections::VecDeque;
use std::future::poll_fn;
use std::rc::Rc;
use std::task::Poll;
use std::time::Duration;

/// Bytes that the rig can queue for the line, as in a board's transmit buffer. A frame of samples is at most 40.
pub(crate) const TRANSMIT_BUFFER: usize = 512;

/// Bits on the line for each byte: start, eight, stop.
const BITS_PER_BYTE: u64 = 10;

/// One direction.
#[derive(Debug, Default)]
struct Lane {
    /// Queued, not yet transmitted.
    waiting: VecDeque<u8>,
    /// Transmitted, not yet read.
    arrived: VecDeque<u8>,
    /// Transmitted part of the next byte (bit · ns per s).
    credit: u64,
}

impl Lane {
    /// Transmits for `elapsed`.
    fn advance(&mut self, elapsed: Duration, speed: LineSpeed) {
        let through = match speed {
            LineSpeed::Unlimited => self.waiting.len(),
            LineSpeed::Baud(baud) => {
                const BYTE: u64 = BITS_PER_BYTE * 1_000_000_000;
                let elapsed = u64::try_from(elapsed.as_nanos()).unwrap_or(u64::MAX);
                self.credit = self
                    .credit
                    .saturating_add(elapsed.saturating_mul(baud.into()));
                let through = usize::try_from(self.credit / BYTE).unwrap_or(usize::MAX);
                self.credit %= BYTE;
                through
            }
        };
        if through >= self.waiting.len() {
            // An idle line accumulates no capacity.
            self.credit = 0;
            self.arrived.append(&mut self.waiting);
        } else {
            self.arrived.extend(self.waiting.drain(..through));
        }
    }

    /// Copies the received bytes to `buffer`; returns how many bytes.
    fn take(&mut self, buffer: &mut [u8]) -> usize {
        let count = buffer.len().min(self.arrived.len());
        for (slot, byte) in buffer.iter_mut().zip(self.arrived.drain(..count)) {
            *slot = byte;
        }
        count
    }
}

/// Both directions.
#[derive(Debug)]
pub(crate) struct SerialLine {
    speed: LineSpeed,
    to_rig: Lane,
    to_host: Lane,
}

impl SerialLine {
    pub(crate) fn new(speed: LineSpeed) -> Self {
        Self {
            speed,
            to_rig: Lane::default(),
            to_host: Lane::default(),
        }
    }

    /// Transmits for `elapsed` of simulated time.
    pub(crate) fn advance(&mut self, elapsed: Duration) {
        self.to_rig.advance(elapsed, self.speed);
        self.to_host.advance(elapsed, self.speed);
    }

    /// The host sends bytes; its buffer is unlimited.
    pub(crate) fn host_writes(&mut self, bytes: &[u8]) {
        self.to_rig.waiting.extend(bytes);
    }

    /// The host reads the received bytes.
    pub(crate) fn host_reads(&mut self, buffer: &mut [u8]) -> usize {
        self.to_host.take(buffer)
    }
}

/// The rig's end of the line.
#[derive(Debug)]
pub(crate) struct RigEnd(pub(crate) Rc<RefCell<SerialLine>>);

impl Link for RigEnd {
    async fn receive(&mut self, buffer: &mut [u8]) -> usize {
        // Never wakes by itself: the driver of the simulation polls after each step of time.
        poll_fn(|_| match self.0.borrow_mut().to_rig.take(buffer) {
            0 => Poll::Pending,
            count => Poll::Ready(count),
        })
        .await
    }

    fn try_send(&mut self, bytes: &[u8]) -> bool {
        let waiting = &mut self.0.borrow_mut().to_host.waiting;
        let fits = waiting.len() + bytes.len() <= TRANSMIT_BUFFER;
        if fits {
            waiting.extend(bytes);
        }
        fits
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_take_their_time_and_keep_their_order() {
        let line = Rc::new(RefCell::new(SerialLine::new(LineSpeed::Baud(115_200))));
        let mut rig = RigEnd(line.clone());
        let sent: Vec<u8> = (0..=255).chain(0..=255).collect();
        assert!(rig.try_send(&sent));
        let mut received = Vec::new();
        let mut buffer = [0; 1000];
        let mut counts = Vec::new();
        for _ in 0..3 {
            line.borrow_mut().advance(Duration::from_millis(20));
            let count = line.borrow_mut().host_reads(&mut buffer);
            received.extend_from_slice(&buffer[..count]);
            counts.push(count);
        }
        // 11 520 bytes/s are 230.4 in 20 ms; the fraction is carried over.
        assert_eq!(counts, [230, 230, 52]);
        assert_eq!(received, sent);
    }

    #[test]
    fn a_full_buffer_takes_all_or_nothing() {
        let line = Rc::new(RefCell::new(SerialLine::new(LineSpeed::Baud(115_200))));
        let mut rig = RigEnd(line.clone());
        assert!(rig.try_send(&[1; TRANSMIT_BUFFER - 10]));
        assert!(!rig.try_send(&[2; 11]));
        assert!(rig.try_send(&[3; 10]));
        line.borrow_mut().advance(Duration::from_secs(1));
        let mut buffer = [0; 1000];
        assert_eq!(line.borrow_mut().host_reads(&mut buffer), TRANSMIT_BUFFER);
        assert!(!buffer.contains(&2));
    }

    #[test]
    fn an_idle_line_saves_nothing_up() {
        let mut line = SerialLine::new(LineSpeed::Baud(10));
        line.advance(Duration::from_millis(1900));
        line.host_writes(&[1, 2]);
        line.advance(Duration::from_millis(900));
        assert_eq!(line.to_rig.arrived.len(), 0);
        line.advance(Duration::from_millis(100));
        assert_eq!(line.to_rig.arrived.len(), 1);
    }
}
