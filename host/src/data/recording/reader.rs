//! Reads a recording, and judges whether it is complete, partial, or damaged.

use super::header::Header;
use super::read_error::{ReadError, ReadFault};
use super::row::{MOST_SAMPLES, Row};
use super::scan::{Damage, LastLineFound, Scan, scan};
use crate::data::input_file;
use servoid_protocol::timing::SAMPLES_PER_FRAME;
use std::ops::Range;
use std::path::Path;

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

impl Recording {
    /// Reads a recording.
    pub fn read(path: &Path) -> Result<Self, ReadError> {
        let bytes = input_file::read(path).map_err(ReadFault::Unreadable);
        Self::parse(&bytes.map_err(ReadError::at(path))?, path)
    }

    /// Reads a recording from memory; `path` is what error texts call it.
    pub fn parse(bytes: &[u8], path: &Path) -> Result<Self, ReadError> {
        Self::of(bytes).map_err(ReadError::at(path))
    }

    pub(crate) fn of(bytes: &[u8]) -> Result<Self, ReadFault> {
        let scanned = scan(bytes)?;
        if let Some(Damage { row, line, reason }) = scanned.damages.first().cloned() {
            let sound_rows = !scanned.rows.is_empty();
            return Err(match row {
                Some(row) => ReadFault::DamagedRow {
                    row,
                    line,
                    reason,
                    sound_rows,
                },
                None => ReadFault::DamagedHeader {
                    line,
                    reason,
                    sound_rows,
                },
            });
        }
        let (completeness, lost_samples) = judge(&scanned).map_err(ReadFault::Changed)?;
        Ok(Self {
            rows: scanned.rows,
            header: scanned.header,
            completeness,
            lost_samples,
        })
    }

    /// The samples of the reference alone, without the rest at neutral before and after it.
    pub fn reference_samples(&self) -> Range<u64> {
        self.header.reference_samples().unwrap_or(0..u64::MAX)
    }

    /// The rows of the samples within `range`.
    pub fn rows_of(&self, range: Range<u64>) -> &[Row] {
        rows_of(&self.rows, &range)
    }
}

/// Compares the last line with the rows; returns how complete they are, and the samples that it names as lost.
pub(super) fn judge(scanned: &Scan) -> Result<(Completeness, Vec<Range<u64>>), &'static str> {
    let partial = |why: &str| Ok((Completeness::Partial(why.to_owned()), Vec::new()));
    let end = match &scanned.end {
        LastLineFound::Read(end) => end,
        LastLineFound::Damaged => return partial("its last line is damaged"),
        LastLineFound::Missing if scanned.rows_seen == 0 => return partial("it has no rows"),
        LastLineFound::Missing if scanned.cut_rows > 0 => {
            return partial("its last frame was cut off");
        }
        LastLineFound::Missing if scanned.cut => return partial("the last line was cut off"),
        LastLineFound::Missing => return partial("it has no last line"),
    };
    if end.rows != scanned.rows_seen {
        return Err("the number of rows differs");
    }
    if end.crc32 != format!("{:08x}", scanned.crc32) {
        return Err("the CRC differs");
    }
    let reason = end.reason.clone().unwrap_or("no reason given".to_owned());
    let mut lost = Vec::new();
    for &[first, last] in &end.lost_samples {
        if first > last || last >= MOST_SAMPLES {
            return Err("the samples that it names as lost are not those of a run");
        }
        lost.push(first..last + 1);
    }
    if lost
        .iter()
        .any(|lost| !rows_of(&scanned.rows, lost).is_empty())
    {
        return Err("samples that it names as lost are there");
    }
    let completeness = match end.end.as_str() {
        "partial" => return Ok((Completeness::Partial(reason), lost)),
        "early" => Completeness::Early(reason),
        "complete" if has_whole_run(scanned) => Completeness::Complete,
        "complete" => return Err("it is marked complete, and is shorter or longer than its run"),
        _ => return partial("its last line is damaged"),
    };
    if !lost.is_empty() || !is_gapless(&scanned.rows) {
        return Err("nothing is marked as missing, and something is");
    }
    Ok((completeness, lost))
}

/// The rows of the samples within `range`: sample numbers rise.
fn rows_of<'a>(rows: &'a [Row], range: &Range<u64>) -> &'a [Row] {
    let at = |sample: u64| rows.partition_point(|row| row.sample < sample);
    rows.get(at(range.start)..at(range.end)).unwrap_or_default()
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
