//! Reads a recording and says whether it is complete, partial, or damaged.

use super::header::{FORMAT, Header};
use super::row::{MOST_SAMPLES, Row};
use super::scan::{Damage, LastLine, Newer, Scan, scan};
use servoid_protocol::timing::SAMPLES_PER_FRAME;
use std::ops::Range;
use std::path::{Path, PathBuf};
use toml::{Table, Value};

/// Whether all of the run is there.
#[derive(Clone, Debug, PartialEq)]
pub enum Completeness {
    /// Every sample, proved by row count and CRC.
    Complete,
    /// Every sample until the run was ended on purpose, proved as well, and the aim that had been reached.
    Early(String),
    /// Samples are missing, and why.
    Partial(String),
}

/// A recording that has been read.
#[derive(Clone, Debug)]
pub struct Recording {
    /// Where it comes from.
    pub header: Header,
    /// Its rows. Their sample numbers rise; a number that is left out is a lost sample.
    pub rows: Vec<Row>,
    /// Whether all of the run is there.
    pub completeness: Completeness,
    /// The samples that the last line names as lost.
    pub lost_samples: Vec<Range<u64>>,
}

/// Why a recording could not be read. The text names the remedy.
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
    #[error(
        "{path:?} is damaged above its rows, at line {line}: {reason}; 'servoid recover' keeps what is sound"
    )]
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
        "{path:?} is damaged at row {row} (line {line}): {reason}; 'servoid recover' keeps what is sound"
    )]
    DamagedRow {
        /// Which.
        path: PathBuf,
        /// Row, from 1.
        row: usize,
        /// Line, from 1.
        line: usize,
        /// What is wrong.
        reason: String,
    },
    /// Not one frame is sound.
    #[error("{path:?} has no sound frame left: nothing can be recovered from it")]
    NothingSound {
        /// Which.
        path: PathBuf,
    },
    /// Every row reads well, and yet rows are not as they were written.
    #[error(
        "{path:?} was changed after it was recorded: its rows do not match its last line ({what}); if you meant to, 'servoid recover' makes a partial recording of it"
    )]
    Changed {
        /// Which.
        path: PathBuf,
        /// What does not match.
        what: &'static str,
    },
}

impl Recording {
    /// Reads a recording.
    ///
    /// # Errors
    /// [`ReadError`].
    pub fn read(path: &Path) -> Result<Self, ReadError> {
        let bytes =
            crate::data::input_file::read(path).map_err(|reason| ReadError::Unreadable {
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
        let scanned = scan(bytes).map_err(|Newer(format)| ReadError::Newer {
            path: path.to_owned(),
            format,
        })?;
        if let Some(damage) = scanned.damages.first() {
            return Err(damaged(damage, path));
        }
        let (completeness, lost_samples) = judge(&scanned).map_err(|what| ReadError::Changed {
            path: path.to_owned(),
            what,
        })?;
        Ok(Self {
            rows: scanned.rows,
            header: scanned.header,
            completeness,
            lost_samples,
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

    /// The rows of the samples within `range`.
    #[must_use]
    pub fn rows_of(&self, range: Range<u64>) -> &[Row] {
        // Sample numbers rise.
        let at = |sample: u64| self.rows.partition_point(|row| row.sample < sample);
        self.rows
            .get(at(range.start)..at(range.end))
            .unwrap_or_default()
    }
}

pub(super) fn damaged(damage: &Damage, path: &Path) -> ReadError {
    let (path, line, reason) = (path.to_owned(), damage.line, damage.reason.clone());
    match damage.row {
        Some(row) => ReadError::DamagedRow {
            path,
            row,
            line,
            reason,
        },
        None => ReadError::DamagedHeader { path, line, reason },
    }
}

/// Holds the last line against the rows; returns how complete they are, and the samples that it names as lost.
pub(super) fn judge(scanned: &Scan) -> Result<(Completeness, Vec<Range<u64>>), &'static str> {
    let partial = |why: &str| Ok((Completeness::Partial(why.to_owned()), Vec::new()));
    let end = match &scanned.last_line {
        LastLine::Read(end) => end,
        LastLine::Damaged => return partial("its last line is damaged"),
        LastLine::Missing if scanned.rows_seen == 0 => return partial("it has no rows"),
        LastLine::Missing if scanned.cut_rows > 0 => return partial("its last frame was cut off"),
        LastLine::Missing if scanned.cut => return partial("the last line was cut off"),
        LastLine::Missing => return partial("it has no last line"),
    };
    let text = |key| end.get(key).and_then(Value::as_str);
    let rows = i64::try_from(scanned.rows_seen).ok();
    if end.get("rows").and_then(Value::as_integer) != rows {
        return Err("the number of rows differs");
    }
    if text("crc32") != Some(format!("{:08x}", scanned.crc32).as_str()) {
        return Err("the CRC differs");
    }
    let reason = text("reason").unwrap_or("it says so").to_owned();
    let lost =
        lost_samples(end).ok_or("the samples that it names as lost are not those of a run")?;
    let is_there = |range: &Range<u64>| {
        let from = scanned.rows.partition_point(|row| row.sample < range.start);
        scanned
            .rows
            .get(from)
            .is_some_and(|row| row.sample < range.end)
    };
    if lost.iter().any(is_there) {
        return Err("samples that it names as lost are there");
    }
    let completeness = match text("end") {
        Some("partial") => return Ok((Completeness::Partial(reason), lost)),
        Some("early") => Completeness::Early(reason),
        Some("complete") if has_whole_run(scanned) => Completeness::Complete,
        Some("complete") => return Err("it says complete, and is shorter or longer than its run"),
        _ => return partial("its last line is damaged"),
    };
    if !lost.is_empty() || !is_gapless(&scanned.rows) {
        return Err("it says that nothing is missing, and something is");
    }
    Ok((completeness, lost))
}

/// Whether the samples are 0, 1, 2 and so on.
fn is_gapless(rows: &[Row]) -> bool {
    (0..).zip(rows).all(|(number, row)| row.sample == number)
}

/// Whether there are as many rows as the header's frames have; one that does not say is believed.
fn has_whole_run(scanned: &Scan) -> bool {
    let header = &scanned.header;
    let rest = u64::from(header.pre_roll_frames) + u64::from(header.post_roll_frames);
    let frames = rest + u64::from(header.reference_frames);
    header.reference_frames == 0 || scanned.rows.len() as u64 == frames * SAMPLES_PER_FRAME as u64
}

/// The stretches named as lost; `None` where they make no sense.
fn lost_samples(end: &Table) -> Option<Vec<Range<u64>>> {
    let sample = |value: &Value| {
        let number = u64::try_from(value.as_integer()?).ok();
        number.filter(|number| *number < MOST_SAMPLES)
    };
    let range = |value: &Value| match value.as_array()?.as_slice() {
        [first, last] => {
            let (first, last) = (sample(first)?, sample(last)?);
            (first <= last).then_some(first..last + 1)
        }
        _ => None,
    };
    let lost = end.get("lost_samples").and_then(Value::as_array);
    lost.into_iter().flatten().map(range).collect()
}
