//! A file's lines, taken apart; what is wrong is noted, and reading goes on.

use super::exact::ExactReader;
use super::header::{FIRST_LINE, HEADER_CRC};
use super::row::{MOST_SAMPLES, Row, RowFormat};
use super::{COLUMNS, FORMAT, Header};
use crc::{CRC_32_ISO_HDLC, Crc};
use servoid_protocol::framing::CRC;
use servoid_protocol::timing::{SAMPLE_US, SAMPLES_PER_FRAME};
use std::ops::Range;
use toml::{Table, Value};

/// The CRC of rows: [`CRC`], by a table that takes sixteen bytes at a time.
static ROWS_CRC: Crc<u32, crc::Table<16>> = Crc::<u32, crc::Table<16>>::new(&CRC_32_ISO_HDLC);

/// Bytes of the shortest row that can be written.
const SHORTEST_ROW: usize = "0,0.000,0,0.0000,0\n".len();

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

/// Lines among which the row of column names is, with room for keys that are not known yet.
const MOST_HEADER_LINES: usize = 100;

/// Whether `bytes` look like a recording of this program, sound or damaged or cut short, rather than
/// any other CSV file: by its first line, its columns, or the other keys of its header.
#[must_use]
pub fn is_recording(bytes: &[u8]) -> bool {
    let begins = bytes.starts_with(FIRST_LINE.as_bytes())
        || FIRST_LINE.as_bytes().starts_with(bytes.trim_ascii_end());
    begins || column_row(bytes).is_some() || has_header_keys(bytes)
}

/// Number of the line, from 1, with the names of the columns.
fn column_row(bytes: &[u8]) -> Option<usize> {
    let lines = bytes.split(|&b| b == b'\n').take(MOST_HEADER_LINES);
    lines
        .zip(1..)
        .find(|(line, _)| is_column_row(line))
        .map(|(_, number)| number)
}

/// Whether comments as the writer's are there; two, since one may be in anybody's file.
fn has_header_keys(bytes: &[u8]) -> bool {
    let keys = [
        "# servoid = ",
        "# started = ",
        "# condition = ",
        "# sample_period_s = ",
    ];
    let lines = bytes.split(|&b| b == b'\n').take(MOST_HEADER_LINES);
    let ours = |line: &&[u8]| keys.iter().any(|key| line.starts_with(key.as_bytes()));
    lines.filter(ours).take(2).count() == 2
}

fn is_column_row(line: &[u8]) -> bool {
    line.trim_ascii_end() == COLUMNS.join(",").as_bytes()
}

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
    let header = read_header(&mut lines, column_row(body), &mut damages)?;
    let header_is_sound = damages.is_empty();
    hold_period_against_rows(&header, &mut damages);
    let mut rows = Rows::new(body, &header, damages);
    for line in lines {
        rows.take(&line);
    }
    rows.sum();
    let last = rows.last_line_number;
    if rows.frames_are_whole {
        rows.check_frame();
    }
    if let Some((number, reason)) = rows.strange_comment.take() {
        // In its last place a comment that cannot be read is the last line, damaged.
        if number == last {
            rows.last_line = LastLine::Damaged;
        } else {
            rows.damaged(number, reason);
        }
    }
    rows.damages.sort_by_key(|damage| damage.line);
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

/// A line, its line end included.
struct Line<'a> {
    /// From 1.
    number: usize,
    /// Where it is among the bytes.
    place: Range<usize>,
    bytes: &'a [u8],
}

/// The lines of a file that ends with a line end.
struct Lines<'a> {
    body: &'a [u8],
    ends: memchr::Memchr<'a>,
    start: usize,
    number: usize,
}

impl<'a> Lines<'a> {
    fn new(body: &'a [u8]) -> Self {
        Self {
            body,
            ends: memchr::memchr_iter(b'\n', body),
            start: 0,
            number: 0,
        }
    }
}

impl<'a> Iterator for Lines<'a> {
    type Item = Line<'a>;

    fn next(&mut self) -> Option<Line<'a>> {
        let place = self.start..self.ends.next()? + 1;
        self.start = place.end;
        self.number += 1;
        Some(Line {
            number: self.number,
            bytes: self.body.get(place.clone())?,
            place,
        })
    }
}

/// Times in rows are made of the period that every rig has: a header with another one would make
/// every time in the results wrong.
fn hold_period_against_rows(header: &Header, damages: &mut Vec<Damage>) {
    let (said, written) = (header.sample_period_s, SAMPLE_PERIOD_S);
    // Far above the rounding of a number in text, far below what any clock is off by.
    let equal = (said - written).abs() <= 1e-9 * written;
    if !equal {
        damages.push(Damage {
            row: None,
            line: 1,
            reason: format!(
                "sample_period_s is {said}, and the rows are written {written} s apart"
            ),
        });
    }
}

/// Reads up to the row of column names, which is the line `columns` where there is one.
fn read_header(
    lines: &mut Lines<'_>,
    columns: Option<usize>,
    damages: &mut Vec<Damage>,
) -> Result<Header, Newer> {
    let (mut table, mut digest, mut sealed) = (Table::new(), CRC.digest(), None);
    let mut damage = |line, reason: &str| {
        damages.push(Damage {
            row: None,
            line,
            reason: reason.to_owned(),
        });
    };
    let (mut last, mut rows_follow) = (0, false);
    for Line { number, bytes, .. } in lines {
        last = number;
        let text = bytes.trim_ascii_end();
        let Some(comment) = text.strip_prefix(b"#") else {
            if columns.is_some_and(|columns| number < columns) {
                damage(number, "it is not of the form '# key = value'");
                digest.update(bytes);
                continue;
            }
            if !is_column_row(text) {
                damage(number, "the column names are wrong");
            }
            rows_follow = true;
            break;
        };
        match comment_table(comment) {
            Ok(entry) => {
                if let Some(crc32) = entry.get(HEADER_CRC).and_then(Value::as_str) {
                    let found = format!("{:08x}", digest.clone().finalize());
                    sealed = Some(found == crc32);
                }
                table.extend(entry);
            }
            Err(reason) => damage(number, reason),
        }
        digest.update(bytes);
    }
    let format = table.get("format").and_then(Value::as_integer);
    let format = format.unwrap_or(FORMAT.into());
    if format > i64::from(FORMAT) {
        // A flipped digit is not a newer version: only a sound header says so.
        if sealed != Some(false) {
            return Err(Newer(u32::try_from(format).unwrap_or(u32::MAX)));
        }
    }
    if sealed == Some(false) || (sealed.is_none() && rows_follow && format > 1) {
        damage(last, "the lines above the rows do not match their CRC");
    }
    Ok(table.try_into().unwrap_or_else(|error: toml::de::Error| {
        damage(last, error.message());
        Header::default()
    }))
}

/// A comment is the inside of a TOML inline table: `key = value, key = value`.
fn comment_table(comment: &[u8]) -> Result<Table, &'static str> {
    const FORM: &str = "it is not of the form '# key = value'";
    let text = std::str::from_utf8(comment).map_err(|_| "it is not UTF-8 text")?;
    let table: Result<Table, _> = toml::from_str(&format!("line = {{ {} }}", text.trim()));
    match table.map(|mut table| (table.remove("line"), table.is_empty())) {
        Ok((Some(Value::Table(inner)), true)) => Ok(inner),
        _ => Err(FORM),
    }
}

/// The rows, as they are read.
struct Rows<'a> {
    body: &'a [u8],
    format: RowFormat,
    exact: ExactReader,
    /// From format 2 on rows come in whole frames and are held against themselves.
    frames_are_whole: bool,
    sound: Vec<Row>,
    /// The frame that is being read.
    frame: Vec<FrameRow>,
    /// The number of that frame, by its first sound row.
    frame_number: Option<u64>,
    /// Sound rows in it.
    frame_sound: usize,
    seen: usize,
    newest_sample: Option<u64>,
    digest: crc::Digest<'static, u32, crc::Table<16>>,
    /// Rows that are not in the digest yet: one piece of the body.
    not_summed: Range<usize>,
    last_line: LastLine,
    last_line_number: usize,
    strange_comment: Option<(usize, &'static str)>,
    cut_rows: usize,
    damages: Vec<Damage>,
}

impl<'a> Rows<'a> {
    fn new(body: &'a [u8], header: &Header, damages: Vec<Damage>) -> Self {
        let format = RowFormat::new(header);
        Self {
            body,
            format,
            exact: ExactReader::new(format),
            frames_are_whole: header.format > 1,
            sound: Vec::with_capacity((body.len() / SHORTEST_ROW).min(MOST_SAMPLES as usize)),
            frame: Vec::new(),
            frame_number: None,
            frame_sound: 0,
            seen: 0,
            newest_sample: None,
            digest: ROWS_CRC.digest(),
            not_summed: 0..0,
            last_line: LastLine::Missing,
            last_line_number: 0,
            strange_comment: None,
            cut_rows: 0,
            damages,
        }
    }

    fn damaged(&mut self, line: usize, reason: &str) {
        self.damages.push(Damage {
            row: Some(self.seen + 1),
            line,
            reason: reason.to_owned(),
        });
    }

    /// Brings the digest up to the newest row.
    fn sum(&mut self) {
        let rows = std::mem::take(&mut self.not_summed);
        self.digest.update(self.body.get(rows).unwrap_or_default());
    }

    fn take(&mut self, line: &Line<'_>) {
        let number = line.number;
        self.last_line_number = number;
        if let Some((number, reason)) = self.strange_comment.take() {
            self.damaged(number, reason);
        }
        if matches!(self.last_line, LastLine::Read(_)) {
            self.damaged(number, "something follows the last line");
            return;
        }
        let text = line.bytes.trim_ascii_end();
        if let Some(comment) = text.strip_prefix(b"#") {
            match comment_table(comment) {
                Ok(end) if end.contains_key("end") => self.last_line = LastLine::Read(end),
                Ok(_) if !self.frames_are_whole => {}
                Ok(_) => self.strange_comment = Some((number, "no comment belongs here")),
                Err(reason) => self.strange_comment = Some((number, reason)),
            }
            return;
        }
        if line.place.start != self.not_summed.end {
            self.sum();
            self.not_summed.start = line.place.start;
        }
        self.not_summed.end = line.place.end;
        self.seen += 1;
        if self.frames_are_whole {
            self.take_exactly(number, text);
        } else {
            self.take_loosely(number, text);
        }
    }

    fn take_loosely(&mut self, line: usize, text: &[u8]) {
        let row = self.format.read(text).and_then(|row| self.rising(row));
        match row {
            Ok(row) => self.sound.push(row),
            Err(reason) => self.damages.push(Damage {
                row: Some(self.seen),
                line,
                reason: reason.to_owned(),
            }),
        }
    }

    fn rising(&mut self, row: Row) -> Result<Row, &'static str> {
        if self
            .newest_sample
            .is_some_and(|newest| row.sample <= newest)
        {
            return Err("the sample number does not rise");
        }
        self.newest_sample = Some(row.sample);
        Ok(row)
    }

    fn take_exactly(&mut self, line: usize, text: &[u8]) {
        let row = self.exact.read(text);
        let row = row.and_then(|row| self.rising(row));
        let number = row
            .as_ref()
            .ok()
            .map(|row| row.sample / SAMPLES_PER_FRAME as u64);
        let another = match (self.frame_number, number) {
            (Some(current), Some(number)) => current != number,
            _ => false,
        };
        // A line that was broken in two makes eleven of ten: only sound rows fill a frame.
        if another || self.frame_sound == SAMPLES_PER_FRAME {
            self.check_frame();
        }
        // Counted here, and not by looking through the frame: damage may go on for a whole file.
        self.frame_number = self.frame_number.or(number);
        self.frame_sound += usize::from(row.is_ok());
        self.frame.push((line, self.seen, row));
    }

    /// Judges the frame that has been read: ten sound rows in order, all of one pulse.
    fn check_frame(&mut self) {
        let mut frame = std::mem::take(&mut self.frame);
        if is_perfect(&frame) {
            self.sound
                .extend(frame.iter().filter_map(|(_, _, row)| row.ok()));
        } else {
            self.judge(&frame);
        }
        frame.clear();
        self.frame = frame;
        (self.frame_number, self.frame_sound) = (None, 0);
    }

    /// Finds what is wrong with a frame, or with the end of the file in it.
    fn judge(&mut self, frame: &[FrameRow]) {
        let rows: Vec<Row> = frame.iter().filter_map(|(_, _, row)| row.ok()).collect();
        let before = self.damages.len();
        let mut note = |line: usize, row: usize, reason: &str| {
            self.damages.push(Damage {
                row: Some(row),
                line,
                reason: reason.to_owned(),
            });
        };
        let most = most_common(rows.iter().map(|row| row.pulse));
        for (line, number, row) in frame {
            match row {
                Err(reason) => note(*line, *number, reason),
                Ok(row) if Some(row.pulse) != most => {
                    note(*line, *number, "its reference is not that of its frame");
                }
                Ok(_) => {}
            }
        }
        if self.damages.len() > before {
            return;
        }
        let first = rows.first().map_or(0, |row| row.sample);
        let whole = rows.len() == SAMPLES_PER_FRAME
            && first.is_multiple_of(SAMPLES_PER_FRAME as u64)
            && (first..)
                .zip(&rows)
                .all(|(sample, row)| row.sample == sample);
        if whole {
            self.sound.extend(rows);
        } else if matches!(self.last_line, LastLine::Missing)
            && frame
                .last()
                .is_some_and(|(line, ..)| *line == self.last_line_number)
            && first.is_multiple_of(SAMPLES_PER_FRAME as u64)
            && (first..)
                .zip(&rows)
                .all(|(sample, row)| row.sample == sample)
        {
            self.cut_rows = rows.len();
        } else if let Some((line, number, _)) = frame.last() {
            note_incomplete(&mut self.damages, *line, *number);
        }
    }
}

/// Line, row number and what came of it.
type FrameRow = (usize, usize, Result<Row, &'static str>);

/// Whether these are the ten rows of a frame, all sound.
fn is_perfect(frame: &[FrameRow]) -> bool {
    let Some((_, _, Ok(first))) = frame.first() else {
        return false;
    };
    let fits = |(sample, (_, _, row)): (u64, &FrameRow)| {
        row.is_ok_and(|row| row.sample == sample && row.pulse == first.pulse)
    };
    frame.len() == SAMPLES_PER_FRAME
        && first.sample.is_multiple_of(SAMPLES_PER_FRAME as u64)
        && (first.sample..).zip(frame).all(fits)
}

fn note_incomplete(damages: &mut Vec<Damage>, line: usize, row: usize) {
    damages.push(Damage {
        row: Some(row),
        line,
        reason: "rows of its frame are missing".to_owned(),
    });
}

/// The value that is there most often; of equals the one that comes last.
fn most_common<T: PartialEq + Copy>(values: impl Iterator<Item = T> + Clone) -> Option<T> {
    let count = |value: &T| values.clone().filter(|other| other == value).count();
    values.clone().max_by_key(count)
}
