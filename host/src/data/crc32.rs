//! The CRC-32 of much at once.

use crc::{CRC_32_ISO_HDLC, Crc, Digest, Table};

/// [`framing::CRC`](servoid_protocol::framing::CRC) by a table that takes sixteen bytes at a time: for the
/// rows of recordings and for samples, of which there are millions.
pub(crate) static BULK: Crc<u32, Table<16>> = Crc::<u32, Table<16>>::new(&CRC_32_ISO_HDLC);

/// A CRC of [`BULK`] that is under way.
pub(crate) type BulkDigest = Digest<'static, u32, Table<16>>;

#[cfg(test)]
mod tests {
    use super::*;
    use servoid_protocol::framing::CRC;

    #[test]
    fn it_is_the_one_of_the_wire() {
        let bytes: Vec<u8> = (0..=255).cycle().take(1_000).collect();
        for length in [0, 1, 15, 16, 17, 1_000] {
            let bytes = &bytes[..length];
            assert_eq!(BULK.checksum(bytes), CRC.checksum(bytes), "{length} bytes");
        }
        // The check value of its definition (CRC RevEng catalogue: CRC-32/ISO-HDLC).
        assert_eq!(BULK.checksum(b"123456789"), 0xCBF4_3926);
    }
}
