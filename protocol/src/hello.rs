//! The identity of a rig.
//!
//! [`Hello`] must be readable across versions: a host of any version can ask any rig for it, and
//! report how they differ. **Its layout is frozen.** Fields are never added, removed, reordered or
//! given another meaning. Whatever a later rig adds goes into a new message. The golden bytes in
//! this module's tests check this.

use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// ASCII text of at most 16 bytes, padded with zeros.
#[derive(Clone, Copy, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Text16(pub [u8; 16]);

impl Text16 {
    /// The first 16 bytes of `text`.
    pub fn new(text: &str) -> Self {
        let mut bytes = text.bytes();
        Self(core::array::from_fn(|_| bytes.next().unwrap_or(0)))
    }

    /// The text up to the padding, or up to the first byte that is not printable ASCII.
    pub fn as_str(&self) -> &str {
        let printable = self.0.iter().take_while(|b| matches!(b, b' '..=b'~'));
        let len = printable.count();
        core::str::from_utf8(self.0.get(..len).unwrap_or_default()).unwrap_or_default()
    }
}

impl Default for Text16 {
    /// No text.
    fn default() -> Self {
        Self([0; 16])
    }
}

impl core::fmt::Debug for Text16 {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(f, "{:?}", self.as_str())
    }
}

/// The source of the rig's clock. It limits the error of every time in the recording.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum ClockSource {
    /// The quartz crystal: some tens of ppm.
    Crystal,
    /// The internal RC oscillator, because the crystal did not start: off by -2 to +2.5 % over the temperature
    /// (data sheet DS5319), and so are all times and all pulses.
    InternalRc,
    /// Simulated time: exact.
    Simulated,
}

/// The error of [`ClockSource::InternalRc`] relative to its frequency: the least and the most over the temperature (data
/// sheet DS5319).
pub const INTERNAL_CLOCK_ERROR: [f64; 2] = [-0.02, 0.025];

/// The cause of the rig's last reset.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum ResetCause {
    /// Power was switched on, or the supply had dropped out.
    PowerOn,
    /// The reset pin.
    Pin,
    /// The watchdog: frames had stopped advancing.
    Watchdog,
    /// Requested by the program.
    Software,
    /// A low-power mode was entered against its option bytes.
    LowPower,
    /// Not known.
    Unknown,
}

/// The identity of a rig, and how it measures. Frozen: see the module's text.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Hello {
    /// [`PROTOCOL_VERSION`](crate::schema::PROTOCOL_VERSION) of the rig.
    pub protocol_version: u16,
    /// [`SCHEMA_HASH`](crate::schema::SCHEMA_HASH) of the rig.
    pub schema_hash: u64,
    /// The kind of board, such as `STM32F103C8`.
    pub board: Text16,
    /// The program's version.
    pub build: Text16,
    /// The board's unique number.
    pub unique_id: [u8; 12],
    /// The source of the clock.
    pub clock: ClockSource,
    /// The cause of the last reset.
    pub reset_cause: ResetCause,
    /// Length of a frame (µs), of the train of pulses that the rig is armed for; the usual one while it is not.
    pub frame_us: u32,
    /// Time between two samples (µs), of that train.
    pub sample_us: u32,
    /// From a pulse's rising edge to the start of the frame's first sample (µs).
    pub first_sample_us: u16,
    /// From the start of a sample's first conversion to the end of its last one (µs).
    pub aperture_us: u16,
    /// Conversions summed into one sample.
    pub oversampling: u8,
    /// Counts of a sensor at the supply rail.
    pub full_scale_counts: u16,
    /// Shortest pulse that the board makes for that train (µs).
    pub shortest_pulse_us: u16,
    /// Longest pulse that the board makes for that train (µs).
    pub longest_pulse_us: u16,
    /// Frames that stay in the board's memory and can be sent again.
    pub history_frames: u16,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::framing;
    use crate::message::{Request, RigMessage};

    fn example() -> Hello {
        Hello {
            protocol_version: 1,
            schema_hash: 0x0123_4567_89ab_cdef,
            board: Text16::new("STM32F103C8"),
            build: Text16::new("0.1.0"),
            unique_id: [1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12],
            clock: ClockSource::InternalRc,
            reset_cause: ResetCause::Watchdog,
            frame_us: 20_000,
            sample_us: 2_000,
            first_sample_us: 500,
            aperture_us: 84,
            oversampling: 4,
            full_scale_counts: 16_380,
            shortest_pulse_us: 800,
            longest_pulse_us: 2_200,
            history_frames: 256,
        }
    }

    /// These bytes are the frozen layout. If this test fails, the change breaks every rig in the
    /// field: undo it and put the news into another message.
    #[test]
    fn golden_bytes() {
        let mut buffer = [0; framing::MAX_PAYLOAD];
        let bytes = framing::to_payload(&RigMessage::Hello(example()), &mut buffer).unwrap();
        let expected: &[u8] = &[
            0x01, // RigMessage::Hello
            0x01, // protocol_version
            0xef, 0x9b, 0xaf, 0xcd, 0xf8, 0xac, 0xd1, 0x91, 0x01, // schema_hash
            b'S', b'T', b'M', b'3', b'2', b'F', b'1', b'0', b'3', b'C', b'8', 0, 0, 0, 0,
            0, //
            b'0', b'.', b'1', b'.', b'0', 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, //
            1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12,   // unique_id
            0x01, // clock
            0x02, // reset_cause
            0xa0, 0x9c, 0x01, // frame_us
            0xd0, 0x0f, // sample_us
            0xf4, 0x03, // first_sample_us
            0x54, // aperture_us
            0x04, // oversampling
            0xfc, 0x7f, // full_scale_counts
            0xa0, 0x06, // shortest_pulse_us
            0x98, 0x11, // longest_pulse_us
            0x80, 0x02, // history_frames
        ];
        assert_eq!(bytes, expected);
    }

    /// Asking for a hello is frozen too, or a new host could not ask an old rig.
    #[test]
    fn golden_request() {
        let mut buffer = [0; framing::MAX_PAYLOAD];
        let request = Request {
            session: 0x1234,
            id: 7,
            command: crate::message::Command::Hello,
        };
        let bytes = framing::to_payload(&request, &mut buffer).unwrap();
        assert_eq!(bytes, [0xb4, 0x24, 0x07, 0x01]);
    }

    #[test]
    fn text_is_cut_at_sixteen_bytes_and_at_what_cannot_be_printed() {
        assert_eq!(Text16::new("0.1.0").as_str(), "0.1.0");
        assert_eq!(
            Text16::new("12345678901234567").as_str(),
            "1234567890123456"
        );
        assert_eq!(Text16([0xff; 16]).as_str(), "");
        assert_eq!(Text16::new("a\u{1b}[31m").as_str(), "a");
    }
}
