//! The text of a row: writing it, and reading it again.

use super::header::Header;
use super::row::{Columns, MOST_SAMPLES, Row};
use crate::data::degrees::DegreeScale;
use servoid_protocol::{Counts, PulseWidth};
use std::fmt::Write as _;

/// The check of a row, of which `text` is all before it: a CRC-32 over the header's own CRC and that text. So a row
/// belongs to one recording, and cannot be moved into another one.
fn check(header_crc: &str, text: &[u8]) -> u32 {
    let mut digest = crc32fast::Hasher::new();
    digest.update(header_crc.as_bytes());
    digest.update(text);
    digest.finalize()
}

/// The times of rows, which are this many microseconds apart.
#[derive(Clone, Copy, Debug)]
pub(super) struct RowTimes(pub(super) u16);

impl RowTimes {
    /// Of the rows under this header.
    pub(super) fn under(header: &Header) -> Self {
        Self(header.train_of_rows().sample_us())
    }

    /// Appends the time of a sample (s): milliseconds where every time is a whole number of them, or microseconds. So no row's
    /// time carries a rounding of its own.
    fn write(self, text: &mut String, sample: u64) {
        let time_us = sample.saturating_mul(self.0.into());
        let (seconds, rest) = (time_us / 1_000_000, time_us % 1_000_000);
        let _infallible = match self.is_whole_milliseconds() {
            true => write!(text, "{seconds}.{:03}", rest / 1000),
            false => write!(text, "{seconds}.{rest:06}"),
        };
    }

    /// Whether `time` is that of the sample, as it is written.
    fn is_of(self, time: &[u8], sample: u64) -> bool {
        let time_us = sample * u64::from(self.0);
        match self.is_whole_milliseconds() {
            true => fixed_point::<3>(time) == Some(time_us / 1000),
            false => fixed_point::<6>(time) == Some(time_us),
        }
    }

    fn is_whole_milliseconds(self) -> bool {
        self.0.is_multiple_of(1000)
    }
}

/// Appends a row and its line end.
pub(super) fn write_row(
    text: &mut String,
    times: RowTimes,
    scale: &DegreeScale,
    header_crc: &str,
    row: Row,
) {
    let begin = text.len();
    let _infallible = write!(text, "{},", row.sample);
    times.write(text, row.sample);
    let _infallible = write!(
        text,
        ",{},{:.4},{},{}",
        scale.reference(row.pulse),
        scale.angle(row.counts),
        row.pulse.0,
        row.counts.0,
    );
    let check = check(header_crc, text.get(begin..).unwrap_or_default().as_bytes());
    let _infallible = writeln!(text, ",{check}");
}

/// Fields of a row with its check.
const FIELDS: usize = 7;

/// Reads rows one after the other, and takes none that [`write_row`] would write another way.
#[derive(Debug)]
pub(super) struct RowReader {
    times: RowTimes,
    scale: DegreeScale,
    columns: Columns,
    /// The header's own CRC, where the header is sound: that of a damaged one proves nothing.
    header_crc: Option<String>,
    /// The pulse of the newest row and its reference as it is written: ten rows share them.
    reference: (PulseWidth, String),
}

impl RowReader {
    /// For rows under this header, with these columns.
    pub(super) fn new(header: &Header, columns: Columns, header_crc: Option<String>) -> Self {
        let scale = DegreeScale::of_recording(header);
        let neutral = PulseWidth::NEUTRAL;
        Self {
            times: RowTimes::under(header),
            reference: (neutral, scale.reference(neutral).to_string()),
            scale,
            columns,
            header_crc,
        }
    }

    /// Reads a row, without its line end. The time must be that of the sample, the reference that of the
    /// pulse, and the position that of the counts.
    pub(super) fn read(&mut self, line: &[u8]) -> Result<Row, &'static str> {
        let (line, is_own) = match self.columns {
            Columns::Checked => self.without_check(line),
            Columns::Unchecked | Columns::WithoutPulse => (line, true),
        };
        let mut fields = line.split(|&byte| byte == b',');
        let mut next = || fields.next().ok_or("it has too few fields");
        let (sample, time, reference, position) = (next()?, next()?, next()?, next()?);
        let has_pulse = self.columns.has_pulse();
        let pulse = has_pulse.then(&mut next).transpose()?;
        let counts = next()?;
        if fields.next().is_some() {
            return Err("it has too many fields");
        }
        let sample = whole_number(sample).ok_or("the sample number is no whole number")?;
        if sample >= MOST_SAMPLES {
            return Err("the sample number is beyond any run");
        }
        if !self.times.is_of(time, sample) {
            return Err("its time is not that of its sample number");
        }
        let pulse = match pulse {
            Some(pulse) => {
                let width = whole_number(pulse).and_then(|width| width.try_into().ok());
                PulseWidth(width.ok_or("the pulse is no whole number of microseconds")?)
            }
            None => self
                .pulse_of(reference)
                .ok_or("its reference is that of no pulse")?,
        };
        if pulse != self.reference.0 {
            self.reference = (pulse, self.scale.reference(pulse).to_string());
        }
        if self.reference.1.as_bytes() != reference {
            return Err("its reference is not that of its pulse");
        }
        let counts = whole_number(counts).and_then(|counts| counts.try_into().ok());
        let counts = Counts(counts.ok_or("the counts are no whole number")?);
        if !is_written_as(position, self.scale.angle(counts)) {
            return Err("its position is not that of its counts");
        }
        if !is_own {
            return Err("its check is not that of a row of this recording");
        }
        Ok(Row {
            sample,
            pulse,
            counts,
        })
    }

    /// A row without its check, and whether that is its own. Under a damaged header it may be anybody's, or be
    /// missing.
    fn without_check<'a>(&self, line: &'a [u8]) -> (&'a [u8], bool) {
        let commas = memchr::memchr_iter(b',', line).count();
        let end = memchr::memrchr(b',', line).filter(|_| commas + 1 == FIELDS);
        let (row, last) = match end.and_then(|end| line.split_at_checked(end)) {
            Some((row, last)) => (row, last.get(1..).unwrap_or_default()),
            None => (line, &[][..]),
        };
        let is_own = self
            .header_crc
            .as_ref()
            .is_none_or(|header_crc| whole_number(last) == Some(check(header_crc, row).into()));
        (row, is_own)
    }

    /// The pulse that commands a reference of formats 1 and 2.
    fn pulse_of(&self, reference: &[u8]) -> Option<PulseWidth> {
        let degrees = std::str::from_utf8(reference).ok()?.parse().ok()?;
        self.scale.pulse(degrees)
    }
}

/// Whether `text` is this angle with its four decimals.
fn is_written_as(text: &[u8], angle: f64) -> bool {
    let negative = text.strip_prefix(b"-");
    let digits = fixed_point::<4>(negative.unwrap_or(text));
    digits == Some((angle.abs() * 1e4).round() as u64)
        && negative.is_some() == angle.is_sign_negative()
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

    const HEADER_CRC: &str = "5ad0c1f2";

    fn reader(header: &Header) -> RowReader {
        RowReader::new(header, Columns::Checked, Some(HEADER_CRC.to_owned()))
    }

    fn written(header: &Header, row: Row) -> String {
        let mut text = String::new();
        write_row(
            &mut text,
            RowTimes::under(header),
            &DegreeScale::of_recording(header),
            HEADER_CRC,
            row,
        );
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
        let mut reader = reader(&header());
        let line = written(&header(), row(123_456, 1550, 9000));
        let check = crc32fast::hash(b"5ad0c1f2123456,246.912,5,7.4172,1550,9000");
        assert_eq!(line, format!("123456,246.912,5,7.4172,1550,9000,{check}"));
        assert_eq!(reader.read(line.as_bytes()), Ok(row(123_456, 1550, 9000)));
        let mut of_another_recording = String::new();
        let scale = DegreeScale::of_recording(&header());
        let same = row(123_456, 1550, 9000);
        let times = RowTimes(2_000);
        write_row(&mut of_another_recording, times, &scale, "5ad0c1f3", same);
        let of_another_recording = of_another_recording.trim_end().to_owned();
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
            of_another_recording,
        ] {
            assert_ne!(other, line);
            assert!(reader.read(other.as_bytes()).is_err(), "{other}");
        }
    }

    #[test]
    fn rows_of_other_pulses_have_their_times_in_microseconds() {
        let header = Header {
            pulse_period_us: 3_004,
            ..header()
        };
        let line = written(&header, row(7, 1550, 9000));
        assert!(line.starts_with("7,0.010514,5,7.4172,1550,9000,"), "{line}");
        let mut own = reader(&header);
        assert_eq!(own.read(line.as_bytes()), Ok(row(7, 1550, 9000)));
        for other in [
            line.replace("10514", "10515"),
            line.replace("0.010514", "0.014"),
        ] {
            assert!(own.read(other.as_bytes()).is_err(), "{other}");
        }
    }

    /// At half a digit of a position, 0.01245 deg for one count, the text is what decides.
    #[test]
    fn positions_between_two_digits_are_read_as_they_are_written() {
        let header = Header {
            degrees_per_count: 0.012_45,
            ..header()
        };
        let mut reader = reader(&header);
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
            if let Ok(row) = reader(&header()).read(&line) {
                prop_assert_eq!(written(&header(), row).into_bytes(), line);
            }
        }
    }
}
