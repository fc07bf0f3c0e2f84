//! Reads a row and checks that it is one that this program has written.

use super::header::Header;
use super::row::{MOST_SAMPLES, Row, RowFormat};
use servoid_protocol::timing::SAMPLE_US;
use servoid_protocol::{Counts, Degrees, PulseWidth};

/// Reads rows one after the other.
#[derive(Debug)]
pub(super) struct RowReader {
    format: RowFormat,
    has_pulse: bool,
    /// The pulse of the newest row and its reference as it is written: ten rows share them.
    reference: (PulseWidth, String),
}

impl RowReader {
    /// For rows under this header, with a column of the pulse or without one.
    pub(super) fn new(header: &Header, has_pulse: bool) -> Self {
        let format = RowFormat::new(header);
        Self {
            format,
            has_pulse,
            reference: (
                PulseWidth::NEUTRAL,
                format.reference_text(PulseWidth::NEUTRAL),
            ),
        }
    }

    /// Reads a row, without its line end. The time must be that of the sample, the reference that of the
    /// pulse, and the position that of the counts.
    pub(super) fn read(&mut self, line: &[u8]) -> Result<Row, &'static str> {
        let mut fields = line.split(|&byte| byte == b',');
        let mut next = || fields.next().ok_or("it has too few fields");
        let (sample, time) = (next()?, next()?);
        let (reference, position) = (next()?, next()?);
        let pulse = self.has_pulse.then(&mut next).transpose()?;
        let counts = next()?;
        if fields.next().is_some() {
            return Err("it has too many fields");
        }
        let sample = whole_number(sample).ok_or("the sample number is no whole number")?;
        if sample >= MOST_SAMPLES {
            return Err("the sample number is beyond any run");
        }
        if fixed_point::<3>(time) != Some(sample * u64::from(SAMPLE_US) / 1000) {
            return Err("its time is not that of its sample number");
        }
        let pulse = match pulse {
            Some(pulse) => self.require_reference(pulse, reference)?,
            None => self.pulse_of(reference)?,
        };
        let counts = whole_number(counts)
            .and_then(|counts| u16::try_from(counts).ok())
            .map(Counts)
            .ok_or("the counts are no whole number")?;
        if !self.is_position(position, counts) {
            return Err("its position is not that of its counts");
        }
        Ok(Row {
            sample,
            pulse,
            counts,
        })
    }

    /// Reads a pulse, whose reference must be the one beside it.
    fn require_reference(
        &mut self,
        pulse: &[u8],
        reference: &[u8],
    ) -> Result<PulseWidth, &'static str> {
        let pulse = whole_number(pulse)
            .and_then(|pulse| u16::try_from(pulse).ok())
            .map(PulseWidth)
            .ok_or("the pulse is no whole number of microseconds")?;
        if pulse != self.reference.0 {
            self.reference = (pulse, self.format.reference_text(pulse));
        }
        if self.reference.1.as_bytes() == reference {
            Ok(pulse)
        } else {
            Err("its reference is not that of its pulse")
        }
    }

    /// The pulse that commands a reference of formats 1 and 2.
    fn pulse_of(&mut self, reference: &[u8]) -> Result<PulseWidth, &'static str> {
        if self.reference.1.as_bytes() != reference {
            let text = std::str::from_utf8(reference).map_err(|_| "it is not text")?;
            let degrees = text.parse().map_err(|_| "a field is no number")?;
            let pulse = self.format.servo.pulse(Degrees(degrees));
            let pulse = pulse.ok_or("there is no pulse for its reference")?;
            let written = self.format.reference_text(pulse);
            if written != text {
                return Err("its reference is not that of a whole microsecond");
            }
            self.reference = (pulse, written);
        }
        Ok(self.reference.0)
    }

    /// Whether `text` is how the position of these counts is written.
    fn is_position(&self, text: &[u8], counts: Counts) -> bool {
        let degrees = self.format.sensor.degrees(counts).0;
        let (is_negative, magnitude) = match text {
            [b'-', magnitude @ ..] => (true, magnitude),
            magnitude => (false, magnitude),
        };
        let is_near = fixed_point::<4>(magnitude).is_some_and(|written| {
            let distance = (written as f64 - degrees.abs() * 1e4).abs();
            // Where rounding might go either way, writing it decides.
            distance < 0.49 || self.format.position_text(counts).as_bytes() == text
        });
        is_near && is_negative == degrees.is_sign_negative()
    }
}

/// A number with so many places behind the point, in units of the last one.
fn fixed_point<const PLACES: usize>(text: &[u8]) -> Option<u64> {
    let (whole, places) = text.split_last_chunk::<PLACES>()?;
    let whole = whole_number(whole.strip_suffix(b".")?)?;
    places.iter().try_fold(whole, with_digit)
}

/// A whole number as it is written, without leading zeros. At most 12 digits: neither sample numbers nor
/// seconds of a run come near.
fn whole_number(text: &[u8]) -> Option<u64> {
    if matches!(text, [] | [b'0', _, ..]) || text.len() > 12 {
        return None;
    }
    text.iter().try_fold(0, with_digit)
}

fn with_digit(number: u64, digit: &u8) -> Option<u64> {
    digit
        .is_ascii_digit()
        .then(|| number * 10 + u64::from(digit - b'0'))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn header() -> Header {
        Header {
            neutral_us: 1500,
            us_per_degree: 10.0,
            zero_counts: 8190.0,
            degrees_per_count: 0.009_157,
            ..Header::default()
        }
    }

    fn written(header: &Header, row: Row) -> String {
        let mut text = String::new();
        RowFormat::new(header).write(&mut text, row);
        text.trim_end().to_owned()
    }

    fn row(sample: u64, pulse: u16, counts: u16) -> Row {
        Row {
            sample,
            pulse: PulseWidth(pulse),
            counts: Counts(counts),
        }
    }

    #[test]
    fn a_row_as_it_is_written_is_read_and_no_other_taken_for_it() {
        let mut reader = RowReader::new(&header(), true);
        let line = written(&header(), row(123_456, 1550, 9000));
        assert_eq!(line, "123456,246.912,5,7.4172,1550,9000");
        assert_eq!(reader.read(line.as_bytes()), Ok(row(123_456, 1550, 9000)));
        for other in [
            line.replace("1550", "1551"),
            line.replace("9000", "9001"),
            line.replace("246.912", "246.914"),
            line.replace("246.912", "246.9120"),
            line.replace("246.912", "0246.912"),
            line.replace("123456", "+123456"),
            line.replace(",9000", ",09000"),
            line.replace(",9000", ",9000 "),
            line.replace(",9000", ""),
            line.replace(",7.4172", ",7.4173"),
            line.replace(",7.4172", ",-7.4172"),
            line.replace(",5,", ",5.0,"),
            line.replace(",5,", ",4.9,"),
            format!("{line},"),
        ] {
            assert_ne!(other, line);
            assert!(reader.read(other.as_bytes()).is_err(), "{other}");
        }
    }

    /// At half a digit of a position, 0.01245 deg for one count, the text is what decides.
    #[test]
    fn positions_between_two_digits_are_read_as_they_are_written() {
        let header = Header {
            degrees_per_count: 0.012_45,
            ..header()
        };
        let mut reader = RowReader::new(&header, true);
        for counts in 8_000..8_400 {
            let line = written(&header, row(0, 1500, counts));
            assert!(reader.read(line.as_bytes()).is_ok(), "{line}");
        }
    }

    proptest! {
        /// Whatever byte is changed into whatever other: what is still read is written the same way.
        #[test]
        fn a_row_that_is_read_is_written_the_same_way(
            sample in 0u64..700_000, pulse in 500u16..2500, counts: u16,
            place in 0usize..44, byte: u8,
        ) {
            let mut line = written(&header(), row(sample, pulse, counts)).into_bytes();
            if let Some(there) = line.get_mut(place) {
                *there = byte;
            }
            if let Ok(row) = RowReader::new(&header(), true).read(&line) {
                prop_assert_eq!(written(&header(), row).into_bytes(), line);
            }
        }
    }
}
