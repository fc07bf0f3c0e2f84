//! A file's lines, taken apart; what is wrong is noted, and reading goes on.

mod as_written;
mod comment;
mod damage;
mod head;
mod lines;
mod rows;

pub(super) use damage::Damage;
pub(super) use head::Newer;
pub use head::is_recording;
pub(super) use rows::LastLine;

use super::header::Header;
use super::row::Row;
use as_written::as_written;
use head::{Head, column_row};
use lines::Lines;
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
    pub(super) last_line: LastLine,
    /// The file does not end with a line end.
    pub(super) cut: bool,
    /// Rows of the last frame that were passed over, because the rest of it is missing.
    pub(super) cut_rows: usize,
    /// CRC-32 over the rows.
    pub(super) crc32: u32,
    pub(super) damages: Vec<Damage>,
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
    let head = Head::read(&mut lines, column_row(body))?;
    let mut rows = Rows::new(&head, body.len());
    for line in lines {
        rows.take(&line);
    }
    rows.finish();
    let mut damages = head.damages;
    damages.extend(rows.damages);
    damages.sort_by_key(|damage| damage.line);
    Ok(Scan {
        header: head.header,
        header_is_sound: head.is_sound,
        has_pulse: head.has_pulse,
        rows: rows.sound,
        rows_seen: rows.seen,
        last_line: rows.last_line,
        cut: whole < bytes.len(),
        cut_rows: rows.cut_rows,
        crc32: rows.digest.finalize(),
        damages,
    })
}
