//! Messages to bytes and back.
//!
//! ```text
//!  00 | COBS( payload | CRC-32 of payload, little endian ) | 00
//! ```
//!
//! | part    | rule                                                                                    |
//! |---------|-----------------------------------------------------------------------------------------|
//! | payload | one message in postcard, at most [`MAX_PAYLOAD`] bytes                                   |
//! | CRC-32  | ISO-HDLC (the one of Ethernet and zip)                                                   |
//! | COBS    | consistent overhead byte stuffing: no zero inside, so a zero ends a frame and nothing else |
//! | zeros   | one before, so that junk on the line cannot stick to the frame; one after                |
//!
//! The receiver checks in this order: the length, COBS, the CRC, the message, then that no bytes
//! follow it. A receiver that starts in the middle of a frame loses that frame only.

use crc::{CRC_32_ISO_HDLC, Crc, Table};
use serde::{Serialize, de::DeserializeOwned};
use thiserror::Error;

/// The CRC of frames, of runs, and of recordings.
pub static CRC: Crc<u32, Table<1>> = Crc::<u32, Table<1>>::new(&CRC_32_ISO_HDLC);

/// The largest message (bytes). `Hello`, the longest one today, takes at most 96 bytes; the rest is room to grow.
pub const MAX_PAYLOAD: usize = 128;

const CRC_BYTES: usize = 4;

/// The longest frame on the wire (bytes), both zeros included.
pub const MAX_WIRE: usize = cobs::max_encoding_length(MAX_PAYLOAD + CRC_BYTES) + 2;

/// A message that does not fit [`MAX_PAYLOAD`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[error("the message is longer than {MAX_PAYLOAD} bytes")]
pub struct TooLong;

/// A message in postcard, without CRC and framing.
pub fn to_payload<'a, T: Serialize>(
    message: &T,
    buffer: &'a mut [u8; MAX_PAYLOAD],
) -> Result<&'a [u8], TooLong> {
    postcard::to_slice(message, buffer)
        .map(|bytes| &*bytes)
        .map_err(|_| TooLong)
}

/// A message as it goes over the wire.
///
/// ```
/// use servoid_protocol::{Command, Decoder, Request, framing};
/// let request = Request { session: 1, id: 1, command: Command::KeepAlive };
/// let mut buffer = [0; framing::MAX_WIRE];
/// let wire = framing::encode(&request, &mut buffer)?;
/// let mut decoder = Decoder::new();
/// let received: Vec<Request> = wire.iter().filter_map(|&b| decoder.push(b)).collect();
/// assert_eq!(received, [request]);
/// # Ok::<(), framing::TooLong>(())
/// ```
pub fn encode<'a, T: Serialize>(
    message: &T,
    buffer: &'a mut [u8; MAX_WIRE],
) -> Result<&'a [u8], TooLong> {
    let mut plain = [0; MAX_PAYLOAD + CRC_BYTES];
    let room = plain.first_chunk_mut().ok_or(TooLong)?;
    let len = to_payload(message, room)?.len();
    let end = len + CRC_BYTES;
    let crc = CRC.checksum(plain.get(..len).ok_or(TooLong)?);
    let after = plain.get_mut(len..end).ok_or(TooLong)?;
    after.copy_from_slice(&crc.to_le_bytes());
    let plain = plain.get(..end).ok_or(TooLong)?;
    let stuffed = cobs::try_encode_including_sentinels(plain, buffer).map_err(|_| TooLong)?;
    buffer.get(..stuffed).ok_or(TooLong)
}

/// Numbers of rejected frames, by reason.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Rejects {
    /// Longer than any frame: a zero was lost, or the other end uses another protocol.
    pub too_long: u32,
    /// Not COBS, or too short to hold a CRC.
    pub malformed: u32,
    /// The CRC differs: bytes were changed on the way.
    pub crc: u32,
    /// The CRC is right, but the message is unknown: versions differ.
    pub unknown: u32,
    /// Bytes follow the message: versions differ.
    pub left_over: u32,
}

impl Rejects {
    /// The total.
    pub fn total(&self) -> u32 {
        let r = self;
        let counts = [r.too_long, r.malformed, r.crc, r.unknown, r.left_over];
        counts.into_iter().fold(0, u32::saturating_add)
    }
}

/// Longest frame between its zeros.
const MAX_STUFFED: usize = MAX_WIRE - 2;

/// Bytes to messages.
#[derive(Clone, Debug)]
pub struct Decoder {
    buffer: [u8; MAX_STUFFED],
    len: usize,
    /// The present frame is longer than the buffer. All of it up to its zero is dropped, because its
    /// tail could pass for a frame of its own.
    overflow: bool,
    rejects: Rejects,
}

impl Default for Decoder {
    fn default() -> Self {
        Self::new()
    }
}

impl Decoder {
    /// A decoder before the first byte.
    pub fn new() -> Self {
        Self {
            buffer: [0; MAX_STUFFED],
            len: 0,
            overflow: false,
            rejects: Rejects::default(),
        }
    }

    /// The rejected frames so far.
    pub fn rejects(&self) -> Rejects {
        self.rejects
    }

    /// Takes the next byte; returns the message that it completes.
    pub fn push<T: DeserializeOwned>(&mut self, byte: u8) -> Option<T> {
        if byte != 0 {
            match self.buffer.get_mut(self.len) {
                Some(slot) => {
                    *slot = byte;
                    self.len += 1;
                }
                None => self.overflow = true,
            }
            return None;
        }
        let len = core::mem::take(&mut self.len);
        if core::mem::take(&mut self.overflow) {
            self.rejects.too_long = self.rejects.too_long.saturating_add(1);
            return None;
        }
        if len == 0 {
            return None; // the zero before a frame, or an idle line
        }
        let class = match decode(self.buffer.get_mut(..len).unwrap_or_default()) {
            Ok(message) => return Some(message),
            Err(Reject::Malformed) => &mut self.rejects.malformed,
            Err(Reject::Crc) => &mut self.rejects.crc,
            Err(Reject::Unknown) => &mut self.rejects.unknown,
            Err(Reject::LeftOver) => &mut self.rejects.left_over,
        };
        *class = class.saturating_add(1);
        None
    }
}

enum Reject {
    Malformed,
    Crc,
    Unknown,
    LeftOver,
}

fn decode<T: DeserializeOwned>(stuffed: &mut [u8]) -> Result<T, Reject> {
    let len = cobs::decode_in_place(stuffed).map_err(|_| Reject::Malformed)?;
    let plain = stuffed.get(..len).ok_or(Reject::Malformed)?;
    let (payload, crc) = plain
        .split_last_chunk::<CRC_BYTES>()
        .ok_or(Reject::Malformed)?;
    if CRC.checksum(payload) != u32::from_le_bytes(*crc) {
        return Err(Reject::Crc);
    }
    match postcard::take_from_bytes(payload) {
        Ok((message, [])) => Ok(message),
        Ok(_) => Err(Reject::LeftOver),
        Err(_) => Err(Reject::Unknown),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::message::*;
    use crate::units::{Counts, PulseWidth};
    use proptest::prelude::*;

    fn frame(index: u16, counts: u16) -> RigMessage {
        let samples = [Counts(counts); 10];
        RigMessage::Frame(Frame {
            run: u16::MAX,
            index,
            pulse: PulseWidth(2200),
            samples,
        })
    }

    fn wire(message: &RigMessage) -> Vec<u8> {
        encode(message, &mut [0; MAX_WIRE]).unwrap().to_vec()
    }

    fn receive(decoder: &mut Decoder, bytes: &[u8]) -> Vec<RigMessage> {
        bytes.iter().filter_map(|&b| decoder.push(b)).collect()
    }

    #[test]
    fn a_frame_takes_at_most_40_bytes() {
        let longest = wire(&frame(u16::MAX, Counts::MAX_TWO_BYTES.0));
        assert!(longest.len() <= 40, "{} bytes", longest.len());
        assert_eq!((longest[0], *longest.last().unwrap()), (0, 0));
    }

    #[test]
    fn the_crc_is_the_published_one() {
        // Check value of CRC-32/ISO-HDLC over "123456789" in the catalogue of parametrised CRCs.
        assert_eq!(CRC.checksum(b"123456789"), 0xcbf4_3926);
    }

    #[test]
    fn an_over_long_frame_is_thrown_away_whole() {
        // Its tail is a perfect frame without the zero before it: a decoder that begins anew in the
        // middle would take it.
        let good = wire(&frame(3, 9));
        let mut bytes = vec![1; MAX_WIRE * 3];
        bytes.extend(&good[1..]);
        let mut decoder = Decoder::new();
        assert_eq!(receive(&mut decoder, &bytes), []);
        assert_eq!(
            decoder.rejects(),
            Rejects {
                too_long: 1,
                ..Rejects::default()
            }
        );
        assert_eq!(receive(&mut decoder, &good), [frame(3, 9)]);
    }

    #[test]
    fn each_reject_has_its_class() {
        let with_crc = |payload: &[u8]| {
            let mut plain = payload.to_vec();
            plain.extend(CRC.checksum(payload).to_le_bytes());
            let mut out = vec![0; 200];
            let n = cobs::encode_including_sentinels(&plain, &mut out);
            out.truncate(n);
            out
        };
        let mut flipped = wire(&frame(1, 1));
        flipped[5] ^= 2;
        let none = Rejects::default();
        for (bytes, expected) in [
            (
                vec![0, 9, 1, 1, 0],
                Rejects {
                    malformed: 1,
                    ..none
                },
            ),
            (flipped, Rejects { crc: 1, ..none }),
            (with_crc(&[200]), Rejects { unknown: 1, ..none }),
            (
                with_crc(&[2, 1, 1, 0, 77]),
                Rejects {
                    left_over: 1,
                    ..none
                },
            ),
        ] {
            let mut decoder = Decoder::new();
            assert_eq!(receive(&mut decoder, &bytes), []);
            assert_eq!(decoder.rejects(), expected, "{bytes:?}");
        }
    }

    /// All 19 683 strings of nine of the bytes that stuffing treats apart: zero, and the shortest and longest of its blocks.
    #[test]
    fn every_pattern_of_zeros_comes_back_and_has_none_on_the_wire() {
        for pattern in 0..3u32.pow(9) {
            let letter = |place: u32| [0, 1, 255][(pattern / 3u32.pow(place) % 3) as usize];
            let message: [u8; 9] = core::array::from_fn(|place| letter(place as u32));
            let mut buffer = [0; MAX_WIRE];
            let wire = encode(&message, &mut buffer).unwrap();
            let zeros = wire.iter().filter(|&&byte| byte == 0).count();
            assert_eq!((wire[0], wire[wire.len() - 1], zeros), (0, 0, 2));
            let mut decoder = Decoder::new();
            let mut back = wire
                .iter()
                .filter_map(|&byte| decoder.push::<[u8; 9]>(byte));
            assert_eq!(back.next(), Some(message));
        }
    }

    /// Every byte of a frame, changed to every other.
    #[test]
    fn no_changed_byte_makes_another_message() {
        let message = frame(7, 8_192);
        let right = wire(&message);
        for place in 0..right.len() {
            for value in 0..=u8::MAX {
                let mut changed = right.clone();
                changed[place] = value;
                let received = receive(&mut Decoder::new(), &changed);
                assert!(received.iter().all(|it| *it == message), "{place} {value}");
            }
        }
    }

    /// Every string of up to two bytes.
    #[test]
    fn no_junk_before_a_frame_costs_it() {
        let message = frame(7, 8_192);
        let right = wire(&message);
        for junk in 0..=u16::MAX {
            for length in 0..=2 {
                let mut decoder = Decoder::new();
                assert!(receive(&mut decoder, &junk.to_le_bytes()[..length]).is_empty());
                assert_eq!(receive(&mut decoder, &right), [message], "{junk}");
                if length < 2 && junk > u16::from(u8::MAX) {
                    break;
                }
            }
        }
    }

    proptest! {
        #[test]
        fn junk_before_a_frame_costs_nothing(
            junk in proptest::collection::vec(any::<u8>(), 0..600),
            index: u16,
        ) {
            let mut decoder = Decoder::new();
            let mut bytes = junk;
            bytes.extend(wire(&frame(index, 5)));
            let received = receive(&mut decoder, &bytes);
            prop_assert_eq!(received.last(), Some(&frame(index, 5)));
        }

        /// One flipped bit is never taken for another message: CRC-32 sees every one (its Hamming
        /// distance at this length is 4 or more), unless the flip makes or removes a zero, and then
        /// the pieces have wrong CRCs.
        #[test]
        fn a_flipped_bit_is_never_another_message(index: u16, counts in 0u16..16384, bit in 0usize..300) {
            let message = frame(index, counts);
            let mut bytes = wire(&message);
            let bit = bit % (bytes.len() * 8);
            bytes[bit / 8] ^= 1 << (bit % 8);
            let received = receive(&mut Decoder::new(), &bytes);
            prop_assert!(received.is_empty() || received == [message]);
        }
    }
}
