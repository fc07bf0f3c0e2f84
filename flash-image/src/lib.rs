//! The program for the board, as the bytes of its flash.
//!
//! `cargo fw` makes an ELF file, which holds tables for debuggers beside the program. What a chip gets of it, and what its
//! SHA-256 is taken of, are the bytes of its flash alone.

use object::Endianness;
use object::elf::{ELFCLASS32, EM_ARM, PT_LOAD};
use object::read::elf::{ElfFile32, FileHeader, ProgramHeader};
use sha2::{Digest, Sha256};

/// Start of the flash (RM0008 3.3.3; datasheet DS5319, memory mapping).
pub const FLASH_START: u32 = 0x0800_0000;
/// Flash of an STM32F103C8 (bytes).
pub const FLASH_BYTES: u32 = 64 * 1024;
/// A page, the least that can be erased (bytes): RM0008 3.3.3, medium-density devices.
pub const PAGE_BYTES: u32 = 1024;
/// What erased flash reads as (PM0075).
pub const ERASED: u8 = 0xff;

/// The name of the board in the firmware, by which it answers.
const BOARD: &[u8] = b"STM32F103C8";

/// The addresses of the static memory (datasheet DS5319, memory mapping).
const RAM: std::ops::RangeInclusive<u32> = 0x2000_0000..=0x2000_5000;

/// Why a file is no program for the board.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ImageError {
    /// It is an ELF file, and not one for this chip.
    #[error("this ELF file is no image for an STM32F103C8: {0}")]
    WrongElf(String),
    /// It does not fit.
    #[error("the program has {0} bytes, and the flash of an STM32F103C8 has {FLASH_BYTES}")]
    TooLarge(usize),
    /// It does not begin with a vector table.
    #[error(
        "this is no image for an STM32F103C8: it does not begin with a stack in the chip's memory and a start in its flash"
    )]
    NoVectors,
}

/// The program for the board.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FlashImage {
    bytes: Vec<u8>,
}

impl FlashImage {
    /// Reads the content of a file: an ELF file, or the bytes of the flash from its start on.
    ///
    /// ```
    /// use servoid_flash_image::FlashImage;
    ///
    /// // A stack at the end of the static memory, a start at 0x0800_0100, and nothing else.
    /// let image = FlashImage::from_file(&[0, 0x50, 0, 0x20, 1, 1, 0, 8])?;
    /// assert_eq!(image.pages(), 1);
    /// # Ok::<(), servoid_flash_image::ImageError>(())
    /// ```
    ///
    /// # Errors
    /// Where it is neither.
    pub fn from_file(content: &[u8]) -> Result<Self, ImageError> {
        let bytes = match content.starts_with(&object::elf::ELFMAG) {
            true => loaded(content)?,
            false => content.to_vec(),
        };
        if bytes.len() > FLASH_BYTES as usize {
            return Err(ImageError::TooLarge(bytes.len()));
        }
        let image = Self { bytes };
        match image.starts() {
            true => Ok(image),
            false => Err(ImageError::NoVectors),
        }
    }

    /// Whether the first two words are a stack and a start (Armv7-M ARM, B1.5.3): bit 0 of the start says Thumb.
    fn starts(&self) -> bool {
        let flash = FLASH_START..FLASH_START + FLASH_BYTES;
        match (self.word(0), self.word(4)) {
            (Some(stack), Some(start)) => {
                RAM.contains(&stack)
                    && stack.is_multiple_of(4)
                    && flash.contains(&start)
                    && !start.is_multiple_of(2)
            }
            _ => false,
        }
    }

    fn word(&self, offset: usize) -> Option<u32> {
        let bytes = self.bytes.get(offset..offset + 4)?;
        Some(u32::from_le_bytes(bytes.try_into().ok()?))
    }

    /// Whether it is the rig's firmware: that names the board that it is for, which its answer to the host begins with.
    #[must_use]
    pub fn is_rigs(&self) -> bool {
        let mut parts = self.bytes.windows(BOARD.len());
        parts.any(|part| part == BOARD)
    }

    /// The bytes of the flash, from its start on.
    #[must_use]
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// Pages that it takes.
    #[must_use]
    pub fn pages(&self) -> u32 {
        self.bytes.len().div_ceil(PAGE_BYTES as usize) as u32
    }

    /// The content of a page, filled up with [`ERASED`]; empty behind the last one.
    #[must_use]
    pub fn page(&self, number: u32) -> Vec<u8> {
        let begin = (number * PAGE_BYTES) as usize;
        let rest = self.bytes.get(begin..).unwrap_or_default();
        let mut page: Vec<u8> = rest.iter().copied().take(PAGE_BYTES as usize).collect();
        if !page.is_empty() {
            page.resize(PAGE_BYTES as usize, ERASED);
        }
        page
    }

    /// SHA-256 of the bytes, in hexadecimal digits.
    #[must_use]
    pub fn sha256(&self) -> String {
        let digest = Sha256::digest(&self.bytes);
        digest.iter().map(|byte| format!("{byte:02x}")).collect()
    }
}

/// What a flash tool writes of an ELF file, from the start of the flash on: each segment at its physical address, initial
/// values of variables included.
fn loaded(elf: &[u8]) -> Result<Vec<u8>, ImageError> {
    let wrong = |what: &dyn std::fmt::Display| ImageError::WrongElf(what.to_string());
    // The fifth byte of an ELF file is the width of its addresses: 1 for 32 bits (System V ABI, ELF identification).
    if elf.get(4).is_some_and(|class| *class != ELFCLASS32) {
        return Err(wrong(&"it is for a processor of 64 bits"));
    }
    let file = ElfFile32::<Endianness>::parse(elf).map_err(|e| wrong(&e))?;
    let endian = file.endian();
    if file.elf_header().e_machine(endian) != EM_ARM {
        return Err(wrong(&"it is for another processor"));
    }
    let mut bytes = Vec::new();
    for header in file.elf_program_headers() {
        if header.p_type(endian) != PT_LOAD || header.p_filesz(endian) == 0 {
            continue;
        }
        let (at, length) = (header.p_paddr(endian), header.p_filesz(endian) as usize);
        let data = header.data(endian, elf);
        let data = data.map_err(|()| wrong(&"it is cut off"))?;
        let begin = at.checked_sub(FLASH_START).map(|begin| begin as usize);
        let begin = begin.filter(|begin| begin + length <= FLASH_BYTES as usize);
        let begin = begin
            .ok_or_else(|| wrong(&format!("{length} bytes at {at:#x} are not in its flash")))?;
        bytes.resize(bytes.len().max(begin + length), ERASED);
        if let Some(place) = bytes.get_mut(begin..begin + length) {
            place.copy_from_slice(data);
        }
    }
    match bytes.is_empty() {
        true => Err(wrong(&"there is no program in it")),
        false => Ok(bytes),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn raw(length: usize) -> Vec<u8> {
        let mut bytes = vec![7; length];
        bytes[..8].copy_from_slice(&[0, 0x50, 0, 0x20, 1, 1, 0, 8]);
        bytes
    }

    #[test]
    fn a_raw_file_is_the_flash_from_its_start_on() {
        let image = FlashImage::from_file(&raw(1030)).unwrap();
        assert_eq!(image.pages(), 2);
        assert_eq!(image.page(0), raw(1024));
        assert_eq!(image.page(1)[..7], [7, 7, 7, 7, 7, 7, ERASED]);
        assert_eq!(image.page(1).len(), 1024);
        assert!(image.page(2).is_empty());
    }

    /// The digest is that of FIPS 180-4's function, as sha256sum has it for these eight bytes.
    #[test]
    fn the_digest_is_of_the_bytes() {
        let image = FlashImage::from_file(&raw(8)).unwrap();
        assert_eq!(
            image.sha256(),
            "ac2fbb021cf436536f7d7d9af877597a9d70e29bec6860a992e111ad17298039"
        );
    }

    #[test]
    fn what_is_no_program_for_the_board_says_so() {
        let error = |bytes: &[u8]| FlashImage::from_file(bytes).unwrap_err().to_string();
        assert!(error(b"").contains("no image for an STM32F103C8"));
        assert!(error(&[ERASED; 64]).contains("does not begin with"));
        let pc = error(b"\x7fELF\x02 of a PC");
        assert!(pc.contains("of 64 bits"), "{pc}");
        let mut avr = vec![0; 52];
        avr[..7].copy_from_slice(b"\x7fELF\x01\x01\x01");
        avr[18] = 83;
        assert!(error(&avr).contains("another processor"), "{}", error(&avr));
        assert!(error(b"\x7fELF and no more").contains("no image for an STM32F103C8"));
        assert!(error(&raw(65 * 1024)).contains("has 65536"));
        // An even start would end in a fault: the processor knows Thumb alone.
        let mut even = raw(8);
        even[4] = 0;
        assert_eq!(FlashImage::from_file(&even), Err(ImageError::NoVectors));
    }
}
