//! The electronic signature: flash size and unique number (RM0008 chapter 30).

/// The model: read-only memory.
#[derive(Debug)]
pub struct Signature {
    unique_id: [u8; 12],
    /// Size of the flash (KiB).
    flash_kib: u16,
    /// Whether it can be read at any clock.
    at_any_clock: bool,
}

/// The system clock (MHz) up to which the unique number of some clones can be read.
const SLOW_MHZ: u64 = 24;

impl Signature {
    /// A chip with this unique number, which can be read `at_any_clock` or else only at a slow one, and so much flash.
    pub fn new(unique_id: [u8; 12], flash_kib: u16, at_any_clock: bool) -> Self {
        Self {
            unique_id,
            flash_kib,
            at_any_clock,
        }
    }

    /// The byte at `offset` from 0x1FFF F7E0 while the system clock has `sysclk_mhz`; `None` outside.
    pub fn read_byte(&self, offset: u32, sysclk_mhz: u64) -> Option<u8> {
        let offset = offset as usize;
        let readable = self.at_any_clock || sysclk_mhz <= SLOW_MHZ;
        match offset {
            8..20 if !readable => Some(0xff),
            // 30.1.1
            0..2 => self.flash_kib.to_le_bytes().get(offset).copied(),
            // 30.2: base address 0x1FFF F7E8.
            8..20 => self.unique_id.get(offset - 8).copied(),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(signature: &Signature, offsets: std::ops::Range<u32>, mhz: u64) -> Vec<u8> {
        offsets
            .map(|offset| signature.read_byte(offset, mhz).unwrap())
            .collect()
    }

    #[test]
    fn size_and_number_are_at_their_places() {
        let signature = Signature::new(*b"abcdefghijkl", 64, true);
        assert_eq!(read(&signature, 0..2, 72), [64, 0]);
        assert_eq!(read(&signature, 8..20, 72), b"abcdefghijkl");
        assert_eq!(signature.read_byte(2, 72), None);
        assert_eq!(signature.read_byte(20, 72), None);
    }

    #[test]
    fn the_number_of_a_clone_is_read_at_a_slow_clock_only() {
        let signature = Signature::new(*b"abcdefghijkl", 64, false);
        assert_eq!(read(&signature, 8..20, 8), b"abcdefghijkl");
        assert_eq!(read(&signature, 8..20, 72), [0xff; 12]);
        assert_eq!(read(&signature, 0..2, 72), [64, 0]);
    }
}
