//! The electronic signature: flash size and unique number (RM0008 chapter 30).

/// The model: read-only memory.
#[derive(Debug)]
pub struct Signature {
    unique_id: [u8; 12],
}

/// Kilobytes of an STM32F103C8 (30.1.1).
const FLASH_KILOBYTES: u16 = 64;

impl Signature {
    /// A board with this unique number.
    pub fn new(unique_id: [u8; 12]) -> Self {
        Self { unique_id }
    }

    /// The byte at `offset` from 0x1FFF F7E0; `None` outside.
    pub fn read_byte(&self, offset: u32) -> Option<u8> {
        let offset = offset as usize;
        match offset {
            0..2 => FLASH_KILOBYTES.to_le_bytes().get(offset).copied(),
            // 30.2: base address 0x1FFF F7E8.
            8..20 => self.unique_id.get(offset - 8).copied(),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn size_and_number_are_at_their_places() {
        let signature = Signature::new(*b"abcdefghijkl");
        assert_eq!(
            (0..2)
                .map(|n| signature.read_byte(n).unwrap())
                .collect::<Vec<_>>(),
            [64, 0]
        );
        assert_eq!(
            (8..20)
                .map(|n| signature.read_byte(n).unwrap())
                .collect::<Vec<_>>(),
            b"abcdefghijkl"
        );
        assert_eq!(signature.read_byte(2), None);
        assert_eq!(signature.read_byte(20), None);
    }
}
