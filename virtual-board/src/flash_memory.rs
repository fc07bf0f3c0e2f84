//! The flash memory: pages that are erased whole and written by half-words (programming manual PM0075).

use crate::memory::FLASH_START;
use servoid_flash_image::{ERASED, PAGE_BYTES};

/// The memory.
#[derive(Debug)]
pub struct FlashMemory {
    bytes: Vec<u8>,
    /// Whether reading it out is prevented (PM0075 2.4.1). An option byte says so, which outlives a reset.
    pub protected: bool,
}

impl FlashMemory {
    /// A memory of `kib` kibibytes that begins with `content`.
    pub fn new(content: &[u8], kib: u16, protected: bool) -> Self {
        let size = usize::from(kib) * 1024;
        let mut bytes = content.get(..size).unwrap_or(content).to_vec();
        bytes.resize(size, ERASED);
        Self { bytes, protected }
    }

    /// Its content.
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// The bytes at an address; `None` where some are outside.
    pub fn read(&self, address: u32, length: usize) -> Option<&[u8]> {
        let begin = Self::offset(address)?;
        self.bytes.get(begin..begin + length)
    }

    fn offset(address: u32) -> Option<usize> {
        address.checked_sub(FLASH_START).map(|at| at as usize)
    }

    /// Erases a page; returns whether there is one of that number.
    pub fn erase_page(&mut self, number: usize) -> bool {
        let begin = number * PAGE_BYTES as usize;
        let page = self.bytes.get_mut(begin..begin + PAGE_BYTES as usize);
        page.map(|page| page.fill(ERASED)).is_some()
    }

    /// Erases everything.
    pub fn erase(&mut self) {
        self.bytes.fill(ERASED);
    }

    /// Writes bytes by half-words. One that is not erased stays as it is, unless zero is written (PM0075 2.3.3: PGERR).
    pub fn write(&mut self, address: u32, bytes: &[u8]) {
        let Some(begin) = Self::offset(address) else {
            return;
        };
        let places = self.bytes.get_mut(begin..).unwrap_or_default();
        for (place, half_word) in places.chunks_exact_mut(2).zip(bytes.chunks_exact(2)) {
            if place.iter().all(|byte| *byte == ERASED) || half_word == [0, 0] {
                place.copy_from_slice(half_word);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_erased_half_words_take_a_value_and_every_one_takes_zero() {
        let mut flash = FlashMemory::new(&[1, 2, 3, 4], 64, false);
        flash.write(FLASH_START, &[9, 9, 0, 0, 5, 6]);
        assert_eq!(
            flash.read(FLASH_START, 8),
            Some(&[1, 2, 0, 0, 5, 6, ERASED, ERASED][..])
        );
        assert!(flash.erase_page(0) && !flash.erase_page(64));
        flash.write(FLASH_START, &[9, 9]);
        assert_eq!(flash.read(FLASH_START, 2), Some(&[9, 9][..]));
        assert_eq!(flash.read(FLASH_START + 64 * 1024 - 1, 2), None);
    }
}
