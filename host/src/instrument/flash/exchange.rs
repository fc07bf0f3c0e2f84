//! Bytes out, an acknowledgement in; and the way back to a common beginning after a loss.
//!
//! The bootloader has no time-outs: where a byte of a message is lost, it waits for one more, for ever. Each of its
//! messages ends in an acknowledgement or a refusal, and after a refusal it waits for a command (AN3155 section 3). So
//! whatever it waits for, bytes that are no command bring it to a refusal, one at a time so that none is left over.
//! stm32flash does the same (`stm32_resync`), with bytes in pairs.

use crate::instrument::port::Port;
use std::collections::VecDeque;
use std::io;
use std::time::Duration;

/// The byte by which the bootloader finds the bit rate (section 1).
const SYNC: u8 = 0x7f;
const ACK: u8 = 0x79;
const NACK: u8 = 0x1f;

/// Not the beginning of any command. As the rest of a message it does no harm: 256 times 0xFF with their checksum write
/// what erased flash holds.
const FILLER: u8 = 0xff;
/// Fillers at a time where one is not enough: a message has up to 258 bytes.
const MANY: usize = 64;

/// From the last byte of a message to its answer: adapters and networks hold bytes back.
const ANSWER: Duration = Duration::from_millis(500);
/// A byte at 115200 baud: start, eight bits, parity, stop.
const BYTE: Duration = Duration::from_micros(96);
/// The line is quiet after this time without a byte.
const QUIET: Duration = Duration::from_millis(50);
/// The wait for the answer to one filler.
const HEARD: Duration = Duration::from_millis(250);

/// The most bytes that are waited out: what sends more is no bootloader.
const CHATTER: usize = 1024;

/// Rounds of a resynchronisation: the first ones send one filler, the next ones many, and so on.
const ROUNDS: u32 = 60;
const SINGLE_ROUNDS: u32 = 3;
/// Silent rounds after which nobody is there: by then every message has been filled up.
const SILENT_ROUNDS: u32 = 12;

/// Why an exchange failed.
#[derive(Debug)]
pub(super) enum Failure {
    /// The port is gone.
    Gone(io::Error),
    /// The bootloader refuses a command.
    Refused,
    /// No answer came, or none that makes sense, or a message was disturbed.
    Lost,
}

impl From<io::Error> for Failure {
    fn from(error: io::Error) -> Self {
        Self::Gone(error)
    }
}

/// Whether the other end has been brought to a common beginning.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Resynchronised {
    /// It waits for a command.
    Yes,
    /// It does not say a word.
    Silent,
    /// It says something, and not what it should.
    No,
}

/// The line to a bootloader.
pub(super) struct Exchange<'p> {
    pub(super) port: &'p mut dyn Port,
    /// Whether it is to end.
    pub(super) stop: &'p dyn Fn() -> bool,
    received: VecDeque<u8>,
}

impl<'p> Exchange<'p> {
    pub(super) fn new(port: &'p mut dyn Port, stop: &'p dyn Fn() -> bool) -> Self {
        Self {
            port,
            stop,
            received: VecDeque::new(),
        }
    }

    /// The next byte within `timeout`.
    fn byte(&mut self, timeout: Duration) -> Result<u8, Failure> {
        let deadline = self.port.now() + timeout;
        loop {
            if let Some(byte) = self.received.pop_front() {
                return Ok(byte);
            }
            let left = deadline.saturating_sub(self.port.now());
            let mut buffer = [0; 512];
            let count = self.port.read(&mut buffer, left)?;
            self.received.extend(buffer.iter().take(count));
            if count == 0 && self.port.now() >= deadline {
                return Err(Failure::Lost);
            }
        }
    }

    /// The next `count` bytes.
    pub(super) fn bytes(&mut self, count: usize) -> Result<Vec<u8>, Failure> {
        (0..count).map(|_| self.byte(ANSWER)).collect()
    }

    /// Waits for the acknowledgement of what was sent, which takes the bootloader `work`.
    pub(super) fn acknowledged(&mut self, work: Duration) -> Result<(), Failure> {
        match self.byte(ANSWER + work)? {
            ACK => Ok(()),
            NACK => Err(Failure::Refused),
            _ => Err(Failure::Lost),
        }
    }

    /// Sends bytes that are acknowledged after so much work.
    fn send(&mut self, bytes: &[u8], work: Duration) -> Result<(), Failure> {
        self.port.write_all(bytes)?;
        self.acknowledged(work + BYTE * bytes.len() as u32)
    }

    /// Sends a byte and its complement.
    pub(super) fn command(&mut self, code: u8) -> Result<(), Failure> {
        self.send(&[code, !code], Duration::ZERO)
    }

    /// Sends a message and its checksum.
    pub(super) fn message(&mut self, bytes: &[u8], work: Duration) -> Result<(), Failure> {
        let sum = bytes.iter().fold(0, |sum, byte| sum ^ byte);
        match self.send(&[bytes, &[sum]].concat(), work) {
            // Its checksum was wrong.
            Err(Failure::Refused) => Err(Failure::Lost),
            other => other,
        }
    }

    /// Has the bootloader find the bit rate. One that has found it before takes the byte for a command, and refuses it
    /// when it comes a second time.
    pub(super) fn synchronise(&mut self, many: bool) -> Result<bool, Failure> {
        self.fill(SYNC, many)?;
        Ok(matches!(self.heard(HEARD)?, Some(ACK | NACK)))
    }

    fn fill(&mut self, byte: u8, many: bool) -> io::Result<()> {
        let count = if many { MANY } else { 1 };
        self.port.write_all(&[byte].repeat(count))
    }

    /// The last byte before the line is quiet again, or of very many.
    fn heard(&mut self, first: Duration) -> Result<Option<u8>, Failure> {
        let mut last = None;
        for _ in 0..CHATTER {
            let patience = if last.is_none() { first } else { QUIET };
            match self.byte(patience) {
                Ok(byte) => last = Some(byte),
                Err(Failure::Lost) => break,
                Err(error) => return Err(error),
            }
        }
        Ok(last)
    }

    /// Brings the bootloader to where it waits for a command, whatever it waits for now.
    pub(super) fn resynchronise(&mut self) -> Result<Resynchronised, Failure> {
        let mut silent = 0;
        let _late = self.heard(QUIET)?;
        for round in 0..ROUNDS {
            let many = round % (2 * SINGLE_ROUNDS) >= SINGLE_ROUNDS;
            self.fill(FILLER, many)?;
            match self.heard(HEARD)? {
                // The refusal of one byte: none is left over.
                Some(NACK) if !many => return Ok(Resynchronised::Yes),
                Some(_) => silent = 0,
                None => silent += 1,
            }
            if (self.stop)() {
                break;
            }
            if silent >= SILENT_ROUNDS {
                return Ok(Resynchronised::Silent);
            }
        }
        Ok(Resynchronised::No)
    }
}
