//! A file's lines, taken apart; faults are noted, and reading goes on.

mod as_written;
mod comment;
mod damage;
mod head;
mod rows;

pub(super) use damage::Damage;
pub use head::is_recording;
pub(super) use rows::LastLineFound;

use super::header::Header;
use super::read_error::ReadFault;
use super::row::Row;
use as_written::as_written;
use head::{Head, column_row};
use rows::Rows;

/// A file, taken apart.
#[derive(Debug)]
pub(super) struct Scan {
    pub(super) header: Header,
    /// Whether the lines above the rows are as they were written, as far as that can be known.
    pub(super) header_is_sound: bool,
    /// Whether the rows have a column of the pulse, as from format 3 on.
    pub(super) has_pulse: bool,
    /// Sound rows, in order.
    pub(super) rows: Vec<Row>,
    /// Rows that are there, sound or not.
    pub(super) rows_seen: usize,
    pub(super) end: LastLineFound,
    /// The file does not end with a line end.
    pub(super) cut: bool,
    /// Rows of the last frame that were passed over, because the rest of it is missing.
    pub(super) cut_rows: usize,
    /// CRC-32 over the rows.
    pub(super) crc32: u32,
    pub(super) damages: Vec<Damage>,
}

/// The header of a recording as far as its lines can be read, with the usual values for the others; `None` for one of a later format.
pub fn header_as_it_reads(bytes: &[u8]) -> Option<Header> {
    scan(bytes).ok().map(|found| found.header)
}

/// Takes a file apart; fails for one of a later format.
pub(super) fn scan(bytes: &[u8]) -> Result<Scan, ReadFault> {
    let bytes = &*as_written(bytes);
    // What comes after the last line end was being written when the writer died.
    let whole = memchr::memrchr(b'\n', bytes).map_or(0, |end| end + 1);
    let body = bytes.get(..whole).unwrap_or_default();
    let mut lines = lines(body);
    let head = Head::read(&mut lines, column_row(body))?;
    let mut rows = Rows::new(&head);
    for (number, line) in lines {
        rows.read(number, line);
    }
    rows.finish();
    let mut damages = head.damages;
    damages.extend(rows.damages);
    damages.sort_by_key(|damage| damage.line);
    Ok(Scan {
        header: head.header,
        header_is_sound: head.is_sound,
        has_pulse: head.columns.has_pulse(),
        rows: rows.sound,
        rows_seen: rows.seen,
        end: rows.end,
        cut: whole < bytes.len(),
        cut_rows: rows.cut_rows,
        crc32: rows.digest.finalize(),
        damages,
    })
}

/// The lines of a file that ends with a line end, these included, and their numbers from 1.
fn lines(body: &[u8]) -> impl Iterator<Item = (usize, &[u8])> {
    let mut start = 0;
    let lines = memchr::memchr_iter(b'\n', body).filter_map(move |end| {
        let line = body.get(start..=end);
        start = end + 1;
        line
    });
    (1..).zip(lines)
}
