//! The commands of the bootloader, each as one exchange (AN3155 section 3; codes and lengths held against the source of
//! stm32flash 0.7, `stm32.c`).

use super::exchange::{Exchange, Failure};
use std::time::Duration;

/// Codes of commands.
pub(super) mod code {
    pub(in super::super) const GET: u8 = 0x00;
    pub(in super::super) const GET_ID: u8 = 0x02;
    pub(in super::super) const READ: u8 = 0x11;
    pub(in super::super) const GO: u8 = 0x21;
    pub(in super::super) const WRITE: u8 = 0x31;
    pub(in super::super) const ERASE: u8 = 0x43;
    pub(in super::super) const READ_UNPROTECT: u8 = 0x92;
}

/// The most bytes that one command reads or writes.
pub(super) const BLOCK: usize = 256;

/// Twice the longest times of DS5319's table of the flash memory: to erase a page, or all; to write a half-word.
const ERASE: Duration = Duration::from_millis(80);
const HALF_WORD: Duration = Duration::from_micros(140);

/// What the bootloader says of itself.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Version {
    /// Its version, in binary-coded decimals: 0x22 is 2.2.
    pub(super) version: u8,
    /// The codes of its commands.
    pub(super) commands: Vec<u8>,
}

impl Exchange<'_> {
    /// Get (3.1).
    pub(super) fn get(&mut self) -> Result<Version, Failure> {
        self.command(code::GET)?;
        let bytes = self.counted()?;
        match bytes.split_first() {
            Some((&version, commands)) => Ok(Version {
                version,
                commands: commands.to_vec(),
            }),
            None => Err(Failure::Lost),
        }
    }

    /// Get ID (3.3).
    pub(super) fn get_id(&mut self) -> Result<u16, Failure> {
        self.command(code::GET_ID)?;
        match self.counted()?[..] {
            [high, low] => Ok(u16::from_be_bytes([high, low])),
            _ => Err(Failure::Lost),
        }
    }

    /// A count, so many bytes and one more, and an acknowledgement.
    fn counted(&mut self) -> Result<Vec<u8>, Failure> {
        let count = self.bytes(1)?;
        let count = count.first().copied().unwrap_or_default();
        let bytes = self.bytes(usize::from(count) + 1)?;
        self.acknowledged(Duration::ZERO)?;
        Ok(bytes)
    }

    /// Read Memory (3.4): at most [`BLOCK`] bytes.
    pub(super) fn read(&mut self, address: u32, length: usize) -> Result<Vec<u8>, Failure> {
        self.command(code::READ)?;
        self.address(address)?;
        self.command(count(length)?)?;
        self.bytes(length)
    }

    /// Write Memory (3.6): at most [`BLOCK`] bytes, whole words at the address of one. What the flash refuses is
    /// acknowledged all the same.
    pub(super) fn write(&mut self, address: u32, bytes: &[u8]) -> Result<(), Failure> {
        self.command(code::WRITE)?;
        self.address(address)?;
        let half_words = bytes.len() as u32 / 2;
        self.message(
            &[&[count(bytes.len())?], bytes].concat(),
            HALF_WORD * half_words,
        )
    }

    /// Erase Memory (3.7): these pages, in this order.
    pub(super) fn erase(&mut self, pages: &[u8]) -> Result<(), Failure> {
        self.command(code::ERASE)?;
        self.message(
            &[&[count(pages.len())?], pages].concat(),
            ERASE * pages.len() as u32,
        )
    }

    /// Go (3.5): starts the program with its vector table at the address.
    pub(super) fn go(&mut self, address: u32) -> Result<(), Failure> {
        self.command(code::GO)?;
        self.address(address)
    }

    /// Readout Unprotect (3.12): erases all, and resets the chip.
    pub(super) fn read_unprotect(&mut self) -> Result<(), Failure> {
        self.command(code::READ_UNPROTECT)?;
        self.acknowledged(ERASE)
    }

    fn address(&mut self, address: u32) -> Result<(), Failure> {
        self.message(&address.to_be_bytes(), Duration::ZERO)
    }
}

/// A number of things as the bootloader counts them.
fn count(things: usize) -> Result<u8, Failure> {
    let less_one = things.checked_sub(1);
    less_one
        .and_then(|count| u8::try_from(count).ok())
        .ok_or(Failure::Lost)
}
