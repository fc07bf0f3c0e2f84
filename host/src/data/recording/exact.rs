//! Recognises rows that are as the writer writes them, without writing each of them again.
//!
//! A row says things twice: its time is that of its sample number, its position that of its counts, and
//! ten rows share a reference. The texts of references and positions are remembered from rows that
//! were held against what the writer would have written, so that most rows are proved by comparing
//! bytes.

use super::row::{MOST_SAMPLES, Row, RowFormat};
use servoid_protocol::timing::SAMPLE_US;
use servoid_protocol::{Counts, PulseWidth};

/// Reads rows that a [`RowFormat`] has written (see [`RowFormat::read_exactly`]), many of them.
#[derive(Debug)]
pub(super) struct ExactReader {
    format: RowFormat,
    reference: Option<Reference>,
    /// By counts, as far as they have been seen: at most 65 536.
    positions: Vec<Option<Position>>,
}

/// The reference of the newest row.
#[derive(Debug)]
struct Reference {
    text: Box<[u8]>,
    degrees: f64,
    pulse: Option<PulseWidth>,
}

/// A position and how it is written.
#[derive(Clone, Debug)]
struct Position {
    text: Box<[u8]>,
    degrees: f64,
}

impl ExactReader {
    pub(super) fn new(format: RowFormat) -> Self {
        Self {
            format,
            reference: None,
            positions: Vec::new(),
        }
    }

    /// Reads a row, without its line end.
    pub(super) fn read(&mut self, line: &[u8]) -> Result<Row, &'static str> {
        if let Some(row) = self.recognise(line) {
            return Ok(row);
        }
        let row = self.format.read_exactly(line)?;
        self.remember(line, &row);
        Ok(row)
    }

    /// The row, if all of its texts are known.
    fn recognise(&self, line: &[u8]) -> Option<Row> {
        let reference = self.reference.as_ref()?;
        let (sample, rest) = leading_number(line)?;
        let (seconds, rest) = leading_number(rest.strip_prefix(b",")?)?;
        let (milliseconds, rest) = rest.strip_prefix(b".")?.split_first_chunk::<3>()?;
        let milliseconds = digits(milliseconds)?;
        let time_us = (seconds * 1000 + milliseconds) * 1000;
        if sample >= MOST_SAMPLES || sample * u64::from(SAMPLE_US) != time_us {
            return None;
        }
        let rest = rest.strip_prefix(b",")?.strip_prefix(&*reference.text)?;
        let rest = rest.strip_prefix(b",")?;
        let comma = rest.iter().rposition(|&byte| byte == b',')?;
        let (text, counts) = (rest.get(..comma)?, rest.get(comma + 1..)?);
        let (counts, []) = leading_number(counts)? else {
            return None;
        };
        let counts = u16::try_from(counts).ok()?;
        let position = self.positions.get(usize::from(counts))?.as_ref()?;
        (*position.text == *text).then_some(Row {
            sample,
            reference_deg: reference.degrees,
            position_deg: position.degrees,
            counts: Counts(counts),
            pulse: reference.pulse,
        })
    }

    fn remember(&mut self, line: &[u8], row: &Row) {
        let mut fields = line.split(|&byte| byte == b',').skip(2);
        let (Some(reference), Some(position)) = (fields.next(), fields.next()) else {
            return;
        };
        self.reference = Some(Reference {
            text: reference.into(),
            degrees: row.reference_deg,
            pulse: row.pulse,
        });
        let place = usize::from(row.counts.0);
        if place >= self.positions.len() {
            self.positions.resize(place + 1, None);
        }
        if let Some(known) = self.positions.get_mut(place) {
            *known = Some(Position {
                text: position.into(),
                degrees: row.position_deg,
            });
        }
    }
}

/// A whole number as it is written, without leading zeros, and what follows it. At most 12 digits:
/// neither sample numbers nor seconds of a run come near.
fn leading_number(text: &[u8]) -> Option<(u64, &[u8])> {
    let end = text.iter().position(|byte| !byte.is_ascii_digit());
    let (number, rest) = text.split_at_checked(end.unwrap_or(text.len()))?;
    match number {
        [] => None,
        [b'0', _, ..] => None,
        number if number.len() > 12 => None,
        number => Some((digits(number)?, rest)),
    }
}

/// The number that decimal digits stand for.
fn digits(text: &[u8]) -> Option<u64> {
    text.iter().try_fold(0u64, |number, byte| {
        byte.is_ascii_digit()
            .then(|| number * 10 + u64::from(byte - b'0'))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::recording::Header;
    use proptest::prelude::*;

    fn format() -> RowFormat {
        RowFormat::new(&Header {
            neutral_us: 1500,
            us_per_degree: 10.0,
            zero_counts: 8190.0,
            degrees_per_count: 0.009_157,
            ..Header::default()
        })
    }

    fn written(sample: u64, pulse: u16, counts: u16) -> String {
        let mut text = String::new();
        format().write(&mut text, sample, PulseWidth(pulse), Counts(counts));
        text.trim_end().to_owned()
    }

    /// A reader that knows the row's texts.
    fn knowing(sample: u64, pulse: u16, counts: u16) -> ExactReader {
        let mut reader = ExactReader::new(format());
        reader
            .read(written(sample, pulse, counts).as_bytes())
            .unwrap();
        reader
    }

    #[test]
    fn a_row_of_known_texts_is_recognised_and_no_other_taken_for_it() {
        let reader = knowing(7, 1550, 9000);
        let line = written(123_456, 1550, 9000);
        assert!(reader.recognise(line.as_bytes()).is_some());
        for other in [
            written(123_456, 1551, 9000),
            written(123_456, 1550, 9001),
            line.replace("246.912", "246.914"),
            line.replace("246.912", "246.9120"),
            line.replace("246.912", "0246.912"),
            line.replace("123456", "+123456"),
            line.replace(",9000", ",09000"),
            line.replace(",9000", ",9000 "),
            line.replace(",9000", ""),
        ] {
            assert_ne!(other, line);
            assert!(reader.recognise(other.as_bytes()).is_none(), "{other}");
        }
    }

    proptest! {
        /// Whatever byte is changed into whatever other, the two ways of reading agree.
        #[test]
        fn both_ways_of_reading_agree(
            sample in 0u64..700_000, pulse in 500u16..2500, counts: u16,
            place in 0usize..40, byte: u8,
        ) {
            let mut line = written(sample, pulse, counts).into_bytes();
            if let Some(there) = line.get_mut(place) {
                *there = byte;
            }
            let mut reader = knowing(0, pulse, counts);
            prop_assert_eq!(reader.read(&line), format().read_exactly(&line));
        }
    }
}
