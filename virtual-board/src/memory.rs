//! The memory map, and the static memory that processor and DMA share.

use rsemu::core::space::RamStore;
use rsemu::core::value::{Endian, Width};
use std::sync::Arc;

pub use servoid_flash_image::{FLASH_BYTES, FLASH_START};

/// Start of the static memory.
pub const RAM_START: u32 = 0x2000_0000;
/// Its size: 20 KiB.
pub const RAM_BYTES: u32 = 20 * 1024;

/// Content of memory after a loss of the supply.
const GARBAGE: u8 = 0xa5;

/// The static memory. Clones are the same memory.
#[derive(Clone, Debug)]
pub struct Ram(Arc<RamStore>);

impl Default for Ram {
    fn default() -> Self {
        Self::new(RAM_BYTES)
    }
}

impl Ram {
    /// A memory of `bytes`.
    pub fn new(bytes: u32) -> Self {
        let ram = Self(Arc::new(RamStore::new(u64::from(bytes))));
        ram.forget();
        ram
    }

    fn size(&self) -> u64 {
        self.0.len()
    }

    /// The store that the processor reads and writes.
    pub(crate) fn store(&self) -> Arc<RamStore> {
        self.0.clone()
    }

    /// Overwrites the memory, as after a loss of the supply.
    pub fn forget(&self) {
        // The range is the memory's own.
        let _ = self.0.fill(0, self.size(), GARBAGE);
    }

    fn offset(address: u32) -> Option<u64> {
        address.checked_sub(RAM_START).map(u64::from)
    }

    /// Reads 1, 2 or 4 bytes; `None` outside the memory.
    pub fn read(&self, address: u32, bytes: u32) -> Option<u32> {
        let value = self
            .0
            .read_value(Self::offset(address)?, width(bytes)?, Endian::Little);
        value.ok().map(|value| value as u32)
    }

    /// Writes 1, 2 or 4 bytes; `None` outside the memory.
    pub fn write(&self, address: u32, bytes: u32, value: u32) -> Option<()> {
        let offset = Self::offset(address)?;
        self.0
            .write_value(offset, width(bytes)?, value.into(), Endian::Little)
            .ok()
    }

    /// A copy of everything.
    pub fn snapshot(&self) -> Vec<u8> {
        let mut bytes = vec![0; self.size() as usize];
        // The range is the memory's own.
        let _ = self.0.read_at(0, &mut bytes);
        bytes
    }
}

fn width(bytes: u32) -> Option<Width> {
    match bytes {
        1 => Some(Width::U8),
        2 => Some(Width::U16),
        4 => Some(Width::U32),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ends() {
        let ram = Ram::default();
        ram.write(RAM_START + RAM_BYTES - 2, 2, 0x1234).unwrap();
        assert_eq!(ram.read(RAM_START + RAM_BYTES - 1, 1), Some(0x12));
        assert_eq!(ram.read(RAM_START + RAM_BYTES, 1), None);
        assert_eq!(ram.write(RAM_START - 1, 1, 0), None);
        ram.forget();
        assert!(ram.snapshot().iter().all(|&byte| byte == GARBAGE));
    }
}
