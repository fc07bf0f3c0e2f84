//! A file's lines, taken apart; what is wrong is noted, and reading goes on.

mod head;
mod lines;
mod rows;

pub use head::is_recording;

use super::Header;
use super::row::Row;
use crate::data::table::BYTE_ORDER_MARK;
use head::{column_row, hold_period_against_rows, mend_scales, read_header};
use lines::Lines;
use rows::Rows;
use servoid_protocol::timing::SAMPLE_US;
use std::borrow::Cow;
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

/// A file without what editors and other systems put into text: a byte order mark, carriage returns before
/// every line end, empty lines at the end. All of that can be taken out again without a doubt, and the CRCs
/// then prove the rest.
fn as_written(bytes: &[u8]) -> Cow<'_, [u8]> {
    let bytes = bytes.strip_prefix(BYTE_ORDER_MARK).unwrap_or(bytes);
    let ends = || memchr::memchr_iter(b'\n', bytes);
    let returns = ends().all(|end| end.checked_sub(1).and_then(|at| bytes.get(at)) == Some(&b'\r'));
    let mut bytes = match returns && ends().next().is_some() {
        true => Cow::Owned(without_returns(bytes)),
        false => Cow::Borrowed(bytes),
    };
    while bytes.ends_with(b"\n\n") {
        match &mut bytes {
            Cow::Owned(bytes) => drop(bytes.pop()),
            Cow::Borrowed(bytes) => *bytes = bytes.strip_suffix(b"\n").unwrap_or(bytes),
        }
    }
    bytes
}

fn without_returns(bytes: &[u8]) -> Vec<u8> {
    let mut kept = Vec::with_capacity(bytes.len());
    for line in bytes.split_inclusive(|&b| b == b'\n') {
        match line.strip_suffix(b"\r\n") {
            Some(line) => kept.extend(line.iter().chain(b"\n")),
            None => kept.extend(line),
        }
    }
    kept
}

/// Takes a file apart.
pub(super) fn scan(bytes: &[u8]) -> Result<Scan, Newer> {
    let bytes = &*as_written(bytes);
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
