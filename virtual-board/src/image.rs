//! The flash image: its bytes, and the table of its log.

use crate::memory::{RAM_BYTES, RAM_START};
use crate::rtt::Log;
use defmt_decoder::Table;
use object::elf::{ELFMAG, SHF_ALLOC};
use object::read::elf::ElfFile32;
use object::{Endianness, Object, ObjectSection, ObjectSymbol, SectionFlags};
use servoid_flash_image::FlashImage;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// The log's control block (SEGGER RTT).
const RTT: &str = "_SEGGER_RTT";

/// An error for a file that is no image.
#[derive(Debug, Error)]
pub enum ImageError {
    /// The file cannot be read.
    #[error("the image {path} cannot be read: {source}")]
    Read {
        /// The file.
        path: PathBuf,
        /// The error of the system.
        source: std::io::Error,
    },
    /// It is no program for this chip.
    #[error(transparent)]
    NotAnImage(#[from] servoid_flash_image::ImageError),
    /// Its tables cannot be read.
    #[error("this is no image for an STM32F103C8: {0}")]
    Tables(String),
}

/// A program for the chip.
pub struct Image {
    /// The contents of the flash, from its start on.
    pub(crate) flash: Vec<u8>,
    /// The log, if the program has one.
    pub(crate) log: Option<Log>,
    /// Bytes of flash that the program uses.
    pub flash_used: u32,
    /// Bytes of static memory that the program's variables use, as an ELF file says; the rest is for its stack.
    pub ram_used: u32,
}

impl Image {
    /// Reads an ELF file.
    pub fn read(path: &Path) -> Result<Self, ImageError> {
        let bytes = std::fs::read(path).map_err(|source| ImageError::Read {
            path: path.into(),
            source,
        })?;
        Self::parse(&bytes)
    }

    /// A chip without a program: its flash is erased.
    #[must_use]
    pub fn erased() -> Self {
        Self {
            flash: Vec::new(),
            log: None,
            flash_used: 0,
            ram_used: 0,
        }
    }

    /// Parses an ELF file; or the bytes of the flash, which have no table of a log.
    pub fn parse(elf: &[u8]) -> Result<Self, ImageError> {
        let wrong = |what: &dyn std::fmt::Display| ImageError::Tables(what.to_string());
        let flash = FlashImage::from_file(elf)?.bytes().to_vec();
        let flash_used = flash.len() as u32;
        if !elf.starts_with(&ELFMAG) {
            return Ok(Self {
                flash,
                flash_used,
                ..Self::erased()
            });
        }
        let file = ElfFile32::<Endianness>::parse(elf).map_err(|e| wrong(&e))?;
        let control_block = file.symbol_by_name(RTT).map(|rtt| rtt.address() as u32);
        let table =
            Table::parse(elf).map_err(|e| wrong(&format!("its log cannot be read: {e}")))?;
        Ok(Self {
            flash,
            log: control_block
                .zip(table)
                .map(|(at, table)| Log::new(at, table)),
            flash_used,
            ram_used: ram_used(&file),
        })
    }
}

fn ram_used(file: &ElfFile32<'_, Endianness>) -> u32 {
    file.sections()
        .filter(|section| {
            let SectionFlags::Elf { sh_flags } = section.flags() else {
                return false;
            };
            let in_ram = (RAM_START..RAM_START + RAM_BYTES).contains(&(section.address() as u32));
            sh_flags & u64::from(SHF_ALLOC) != 0 && in_ram
        })
        .map(|section| section.size() as u32)
        .sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_image_says_so() {
        let error = Image::parse(b"not an ELF file").err().unwrap();
        assert!(
            error.to_string().contains("no image for an STM32F103C8"),
            "{error}"
        );
        let error = Image::read(Path::new("nowhere")).err().unwrap();
        assert!(error.to_string().contains("nowhere"), "{error}");
    }
}
