//! The flash image: its bytes, and the table of its log.

use crate::memory::{FLASH_BYTES, FLASH_START, RAM_BYTES, RAM_START};
use crate::rtt::Log;
use defmt_decoder::Table;
use object::elf::{PT_LOAD, SHF_ALLOC};
use object::read::elf::{ElfFile32, ProgramHeader};
use object::{Endianness, Object, ObjectSection, ObjectSymbol, SectionFlags};
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
    /// It is not an ELF file for this chip.
    #[error("this is no image for an STM32F103C8: {0}")]
    NotAnImage(String),
}

/// A program for the chip.
pub struct Image {
    /// The contents of the flash.
    pub(crate) flash: Vec<u8>,
    /// The log, if the program has one.
    pub(crate) log: Option<Log>,
    /// Bytes of flash that the program uses.
    pub flash_used: u32,
    /// Bytes of static memory that the program's variables use; the rest is for its stack.
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

    /// Parses an ELF file.
    pub fn parse(elf: &[u8]) -> Result<Self, ImageError> {
        let wrong = |what: &dyn std::fmt::Display| ImageError::NotAnImage(what.to_string());
        let file = ElfFile32::<Endianness>::parse(elf).map_err(|e| wrong(&e))?;
        // Erased flash is all ones (PM0075).
        let mut flash = vec![0xff; FLASH_BYTES as usize];
        let mut flash_used = 0;
        for header in file.elf_program_headers() {
            let endian = file.endian();
            if header.p_type(endian) != PT_LOAD || header.p_filesz(endian) == 0 {
                continue;
            }
            // A flash tool writes to the physical address, initial values included.
            let (at, length) = (header.p_paddr(endian), header.p_filesz(endian));
            let data = header
                .data(endian, elf)
                .map_err(|()| wrong(&"it is cut off"))?;
            let place = at
                .checked_sub(FLASH_START)
                .map(|offset| offset as usize)
                .and_then(|offset| flash.get_mut(offset..offset + length as usize))
                .ok_or_else(|| wrong(&format!("{length} bytes at {at:#x} are not in its flash")))?;
            place.copy_from_slice(data);
            flash_used += length;
        }
        if flash_used == 0 {
            return Err(wrong(&"there is no program in it"));
        }
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
