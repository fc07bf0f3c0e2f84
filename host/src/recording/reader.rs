//! Reading a recording as what it is: complete, partial, or damaged.

use super::{COLUMNS, FORMAT, Header};
use servoid_protocol::framing::CRC;
use servoid_protocol::timing::SAMPLES_PER_FRAME;
use std::ops::Range;
use std::path::{Path, PathBuf};
use toml::Table;

/// Whether all of the run is there.
#[derive(Clone, Debug, PartialEq)]
pub enum Completeness {
    /// Every sample, proved by row count and CRC.
    Complete,
    /// Samples are missing, and why.
    Partial(String),
}

/// A recording that has been read.
#[derive(Clone, Debug)]
pub struct Recording {
    /// Where it comes from.
    pub header: Header,
    /// Sample numbers, rising; a number that is left out is a lost sample.
    pub samples: Vec<u64>,
    /// What the servo was told, by sample (deg).
    pub reference_deg: Vec<f64>,
    /// What the sensor saw, by sample (deg).
    pub position_deg: Vec<f64>,
    /// Whether all of the run is there.
    pub completeness: Completeness,
}

/// Why a recording could not be read. The text says what to do.
#[derive(Debug, thiserror::Error)]
pub enum ReadError {
    /// The file cannot be read.
    #[error("{path:?} cannot be read: {reason}")]
    Unreadable {
        /// Which.
        path: PathBuf,
        /// What the system said.
        reason: std::io::Error,
    },
    /// A later version wrote it.
    #[error(
        "{path:?} was made by a newer servoid (format {format}, this one reads up to {FORMAT}): update servoid"
    )]
    Newer {
        /// Which.
        path: PathBuf,
        /// Its format.
        format: u32,
    },
    /// The comment lines make no sense.
    #[error("{path:?} line {line} is damaged: {reason}")]
    DamagedHeader {
        /// Which.
        path: PathBuf,
        /// Line, from 1.
        line: usize,
        /// What is wrong.
        reason: String,
    },
    /// A row makes no sense.
    #[error(
        "{path:?} is damaged at row {row} (line {line}): {reason}; the rows before it are sound"
    )]
    DamagedRow {
        /// Which.
        path: PathBuf,
        /// Row, from 1.
        row: usize,
        /// Line, from 1.
        line: usize,
        /// What is wrong.
        reason: &'static str,
    },
    /// Every row reads well and yet they are not what was written.
    #[error(
        "{path:?} was changed after it was recorded: its rows do not match its last line ({what}); if you meant to, delete the line that begins with '# end', and it is read as partial"
    )]
    Changed {
        /// Which.
        path: PathBuf,
        /// What does not match.
        what: &'static str,
    },
}

/// Whether `bytes` look like a recording of this program rather than any other CSV file.
#[must_use]
pub fn is_recording(bytes: &[u8]) -> bool {
    lines(bytes)
        .find(|line| !line.starts_with(b"#"))
        .is_some_and(is_column_row)
}

fn is_column_row(line: &[u8]) -> bool {
    line.strip_suffix(b"\r").unwrap_or(line) == COLUMNS.join(",").as_bytes()
}

/// Lines without their ends.
fn lines(bytes: &[u8]) -> impl Iterator<Item = &[u8]> {
    bytes.split(|&b| b == b'\n')
}

impl Recording {
    /// Reads a recording.
    ///
    /// # Errors
    /// [`ReadError`].
    pub fn read(path: &Path) -> Result<Self, ReadError> {
        let bytes = std::fs::read(path).map_err(|reason| ReadError::Unreadable {
            path: path.to_owned(),
            reason,
        })?;
        Self::parse(&bytes, path)
    }

    /// Reads a recording from memory; `path` is what error texts call it.
    ///
    /// # Errors
    /// [`ReadError`].
    pub fn parse(bytes: &[u8], path: &Path) -> Result<Self, ReadError> {
        // What comes after the last line end was being written when the writer died.
        let whole = bytes
            .iter()
            .rposition(|&b| b == b'\n')
            .map_or(0, |end| end + 1);
        let cut_line = whole < bytes.len();
        let mut header = Table::new();
        let mut end = None;
        let mut digest = CRC.digest();
        let mut in_rows = false;
        let mut rows = Rows::default();
        let damaged = |line, reason| ReadError::DamagedHeader {
            path: path.to_owned(),
            line,
            reason,
        };
        let body = bytes.get(..whole).unwrap_or_default();
        for (number, line) in (1..).zip(body.split_inclusive(|&b| b == b'\n')) {
            let text = line.trim_ascii_end();
            if let Some(comment) = text.strip_prefix(b"#") {
                let table = comment_table(comment).map_err(|reason| damaged(number, reason))?;
                if table.contains_key("end") {
                    end = Some(table)
                } else {
                    header.extend(table)
                }
            } else if in_rows {
                digest.update(line);
                rows.push(text).map_err(|reason| ReadError::DamagedRow {
                    path: path.to_owned(),
                    row: rows.samples.len() + 1,
                    line: number,
                    reason,
                })?;
            } else if is_column_row(text) {
                in_rows = true;
            } else {
                return Err(damaged(number, "the column names are wrong".to_owned()));
            }
        }
        let header = typed_header(header, path)?;
        let completeness = match end {
            Some(end) => judge(&end, rows.samples.len(), digest.finalize()).map_err(|what| {
                ReadError::Changed {
                    path: path.to_owned(),
                    what,
                }
            })?,
            None if cut_line => Completeness::Partial("the last line was cut off".to_owned()),
            None => Completeness::Partial("it has no last line".to_owned()),
        };
        let Rows {
            samples,
            reference_deg,
            position_deg,
        } = rows;
        Ok(Self {
            header,
            samples,
            reference_deg,
            position_deg,
            completeness,
        })
    }

    /// The samples of the reference alone, without the rest at neutral before and after it.
    #[must_use]
    pub fn reference_samples(&self) -> Range<u64> {
        let samples = SAMPLES_PER_FRAME as u64;
        let start = u64::from(self.header.pre_roll_frames) * samples;
        match u64::from(self.header.reference_frames) {
            0 => 0..u64::MAX,
            frames => start..start + frames * samples,
        }
    }

    /// Input and output of the samples within `range`, one place per sample from the first to the
    /// last that is there, NaN where one is lost in between.
    #[must_use]
    pub fn columns(&self, range: Range<u64>) -> (Vec<f64>, Vec<f64>) {
        let rows = self
            .samples
            .iter()
            .zip(&self.reference_deg)
            .zip(&self.position_deg);
        let rows: Vec<_> = rows
            .filter(|((sample, _), _)| range.contains(sample))
            .collect();
        let (Some(&((&first, _), _)), Some(&((&last, _), _))) = (rows.first(), rows.last()) else {
            return (Vec::new(), Vec::new());
        };
        // A file cannot make this allocate more than a long run takes: see `Rows::push`.
        let length = (last - first) as usize + 1;
        let (mut input, mut output) = (vec![f64::NAN; length], vec![f64::NAN; length]);
        for ((&sample, &reference), &position) in rows {
            let place = (sample - first) as usize;
            if let (Some(u), Some(y)) = (input.get_mut(place), output.get_mut(place)) {
                (*u, *y) = (reference, position);
            }
        }
        (input, output)
    }
}

/// A comment is the inside of a TOML inline table: `key = value, key = value`.
fn comment_table(comment: &[u8]) -> Result<Table, String> {
    let text = std::str::from_utf8(comment).map_err(|_| "it is not UTF-8 text".to_owned())?;
    let table: Result<Table, _> = toml::from_str(&format!("line = {{ {} }}", text.trim()));
    match table {
        Ok(mut table) => match table.remove("line") {
            Some(toml::Value::Table(inner)) if table.is_empty() => Ok(inner),
            _ => Err("it is not of the form '# key = value'".to_owned()),
        },
        Err(_) => Err("it is not of the form '# key = value'".to_owned()),
    }
}

fn typed_header(table: Table, path: &Path) -> Result<Header, ReadError> {
    let format = table
        .get("format")
        .and_then(toml::Value::as_integer)
        .unwrap_or(FORMAT.into());
    if format > i64::from(FORMAT) {
        let format = u32::try_from(format).unwrap_or(u32::MAX);
        return Err(ReadError::Newer {
            path: path.to_owned(),
            format,
        });
    }
    table
        .try_into()
        .map_err(|error: toml::de::Error| ReadError::DamagedHeader {
            path: path.to_owned(),
            line: 1,
            reason: error.message().to_owned(),
        })
}

/// Holds the last line against the rows.
fn judge(end: &Table, rows: usize, crc: u32) -> Result<Completeness, &'static str> {
    let text = |key| end.get(key).and_then(toml::Value::as_str);
    if end.get("rows").and_then(toml::Value::as_integer) != i64::try_from(rows).ok() {
        return Err("the number of rows differs");
    }
    if text("crc32") != Some(format!("{crc:08x}").as_str()) {
        return Err("the CRC differs");
    }
    match text("end") {
        Some("complete") => Ok(Completeness::Complete),
        _ => Ok(Completeness::Partial(
            text("reason").unwrap_or("it says so").to_owned(),
        )),
    }
}

#[derive(Default)]
struct Rows {
    samples: Vec<u64>,
    reference_deg: Vec<f64>,
    position_deg: Vec<f64>,
}

/// The longest run that the wire can number: 65 536 frames of 10 samples. A sample number beyond
/// it is damage, and must not decide how much memory is taken.
const MOST_SAMPLES: u64 = 65_536 * SAMPLES_PER_FRAME as u64;

impl Rows {
    fn push(&mut self, line: &[u8]) -> Result<(), &'static str> {
        let line = std::str::from_utf8(line).map_err(|_| "it is not text")?;
        let mut fields = line.split(',');
        let mut next = || fields.next().ok_or("it has too few fields");
        let sample: u64 = next()?
            .parse()
            .map_err(|_| "the sample number is no whole number")?;
        let time = next()?;
        let (reference, position) = (next()?, next()?);
        let counts = next()?;
        if fields.next().is_some() {
            return Err("it has too many fields");
        }
        if sample >= MOST_SAMPLES || self.samples.last().is_some_and(|&last| sample <= last) {
            return Err("the sample number does not rise");
        }
        finite(time)?;
        counts
            .parse::<u16>()
            .map_err(|_| "the counts are no whole number")?;
        self.samples.push(sample);
        self.reference_deg.push(finite(reference)?);
        self.position_deg.push(finite(position)?);
        Ok(())
    }
}

fn finite(text: &str) -> Result<f64, &'static str> {
    match text.parse::<f64>() {
        Ok(number) if number.is_finite() => Ok(number),
        _ => Err("a field is no number"),
    }
}
