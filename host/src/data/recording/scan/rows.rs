//! Rows, held against their own frame and against those before them.

use super::head::comment_table;
use super::lines::Line;
use super::{Damage, LastLine};
use crate::data::crc32::{self, BulkDigest};
use crate::data::recording::exact::ExactReader;
use crate::data::recording::row::{MOST_SAMPLES, Row, RowFormat};
use crate::data::recording::{END_CRC, Header};
use servoid_protocol::framing::CRC;
use servoid_protocol::timing::SAMPLES_PER_FRAME;
use std::ops::Range;
use toml::Table;

/// Bytes of the shortest row that can be written.
const SHORTEST_ROW: usize = "0,0.000,0,0.0000,0\n".len();

/// The rows, as they are read.
pub(super) struct Rows<'a> {
    body: &'a [u8],
    format: RowFormat,
    exact: ExactReader,
    /// From format 2 on rows come in whole frames and are held against themselves.
    frames_are_whole: bool,
    pub(super) sound: Vec<Row>,
    /// The frame that is being read.
    frame: Vec<FrameRow>,
    /// The number of that frame, by its first sound row.
    frame_number: Option<u64>,
    /// Sound rows in it.
    frame_sound: usize,
    pub(super) seen: usize,
    newest_sample: Option<u64>,
    pub(super) digest: BulkDigest,
    /// Rows that are not in the digest yet: one piece of the body.
    not_summed: Range<usize>,
    pub(super) last_line: LastLine,
    last_line_number: usize,
    strange_comment: Option<(usize, &'static str)>,
    pub(super) cut_rows: usize,
    pub(super) damages: Vec<Damage>,
}

impl<'a> Rows<'a> {
    pub(super) fn new(body: &'a [u8], header: &Header, damages: Vec<Damage>) -> Self {
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
            digest: crc32::BULK.digest(),
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

    /// Judges what can only be judged when all lines are read.
    pub(super) fn finish(&mut self) {
        self.sum();
        if self.frames_are_whole {
            self.check_frame();
        }
        if let Some((number, reason)) = self.strange_comment.take() {
            // In its last place a comment that cannot be read is the last line, damaged.
            if number == self.last_line_number {
                self.last_line = LastLine::Damaged;
            } else {
                self.damaged(number, reason);
            }
        }
        self.damages.sort_by_key(|damage| damage.line);
    }

    /// Takes in the next line.
    pub(super) fn take(&mut self, line: &Line<'_>) {
        let number = line.number;
        self.last_line_number = number;
        if let Some((number, reason)) = self.strange_comment.take() {
            self.damaged(number, reason);
        }
        if !matches!(self.last_line, LastLine::Missing) {
            self.damaged(number, "something follows the last line");
            return;
        }
        let text = line.bytes.trim_ascii_end();
        if let Some(comment) = text.strip_prefix(b"#") {
            match comment_table(comment) {
                Ok(end) if end.contains_key("end") => {
                    self.last_line = if is_as_written(&end, text) {
                        LastLine::Read(end)
                    } else {
                        LastLine::Damaged
                    };
                }
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

/// Whether a last line, which is `text`, has the keys of one and matches its own CRC, if it has that.
fn is_as_written(end: &Table, text: &[u8]) -> bool {
    const KEYS: [&str; 6] = [
        "end",
        "rows",
        "crc32",
        "reason",
        "lost_samples",
        "end_crc32",
    ];
    let sealed = end.get("end_crc32").is_none_or(|crc32| {
        let own = memchr::memmem::rfind(text, END_CRC.as_bytes()).and_then(|at| text.get(..at));
        let found = own.map(|own| format!("{:08x}", CRC.checksum(own)));
        crc32.as_str() == found.as_deref()
    });
    sealed && end.keys().all(|key| KEYS.contains(&key.as_str()))
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
