//! A file's lines, taken apart; what is wrong is noted, and reading goes on.

mod head;
mod lines;
mod rows;

pub use head::is_recording;

use super::Header;
use super::row::Row;
use head::{column_row, hold_period_against_rows, mend_scales, read_header};
use lines::Lines;
use rows::Rows;
use servoid_protocol::timing::SAMPLE_US;
use toml::Table;

/// Time between rows (s): the format's times are sample numbers times this.
pub(super) const SAMPLE_PERIOD_S: f64 = SAMPLE_US as f64 * 1e-6;

/// Something that is not as it was written.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Damage {
    /// Row, from 1; `None` for the lines above the rows.
    pub(super) row: Option<usize>,
    /// Line, from 1.
    pub(super) line: usize,
    /// What is wrong.
    pub(super) reason: String,
}

/// The last line.
#[derive(Debug)]
pub(super) enum LastLine {
    /// There is none, or only a part of one.
    Missing,
    /// Something else is in its place.
    Damaged,
    /// There is one.
    Read(Table),
}

/// A file, taken apart.
#[derive(Debug)]
pub(super) struct Scan {
    pub(super) header: Header,
    /// Whether the lines above the rows are as they were written, as far as that can be known.
    pub(super) header_is_sound: bool,
    /// Sound rows, in order.
    pub(super) rows: Vec<Row>,
    /// Rows that are there, sound or not.
    pub(super) rows_seen: usize,
    pub(super) last_line: LastLine,
    /// The file does not end with a line end.
    pub(super) cut: bool,
    /// Rows of the last frame that were passed over, because the rest of it is missing.
    pub(super) cut_rows: usize,
    /// CRC-32 over the rows.
    pub(super) crc32: u32,
    pub(super) damages: Vec<Damage>,
}

/// A format that is higher than [`FORMAT`].
#[derive(Debug)]
pub(super) struct Newer(pub(super) u32);

/// Takes a file apart.
pub(super) fn scan(bytes: &[u8]) -> Result<Scan, Newer> {
    // What comes after the last line end was being written when the writer died.
    let whole = bytes
        .iter()
        .rposition(|&b| b == b'\n')
        .map_or(0, |end| end + 1);
    let body = bytes.get(..whole).unwrap_or_default();
    let mut lines = Lines::new(body);
    let mut damages = Vec::new();
    let mut header = read_header(&mut lines, column_row(body), &mut damages)?;
    mend_scales(&mut header, &mut damages);
    let header_is_sound = damages.is_empty();
    hold_period_against_rows(&header, &mut damages);
    let mut rows = Rows::new(body, &header, damages);
    for line in lines {
        rows.take(&line);
    }
    rows.finish();
    Ok(Scan {
        header,
        header_is_sound,
        rows: rows.sound,
        rows_seen: rows.seen,
        last_line: rows.last_line,
        cut: whole < bytes.len(),
        cut_rows: rows.cut_rows,
        crc32: rows.digest.finalize(),
        damages: rows.damages,
    })
}
