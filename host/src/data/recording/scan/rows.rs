//! Rows, held against their own frame and against those before them.

use super::comment::comment_table;
use super::damage::Damage;
use super::head::Head;
use super::lines::Line;
use crate::data::recording::last_line::is_as_written;
use crate::data::recording::row::{MOST_SAMPLES, Row};
use crate::data::recording::row_reader::RowReader;
use servoid_protocol::timing::SAMPLES_PER_FRAME;
use toml::Table;

/// Bytes of the shortest row that can be written.
const SHORTEST_ROW: usize = "0,0.000,0,0.0000,0\n".len();

/// The last line.
#[derive(Debug)]
pub(in crate::data::recording) enum LastLine {
    /// There is none, or only a part of one.
    Missing,
    /// Something else is in its place.
    Damaged,
    /// There is one.
    Read(Table),
}

/// The rows, as they are read.
pub(super) struct Rows {
    reader: RowReader,
    /// From format 2 on rows come in whole frames.
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
    pub(super) digest: crc32fast::Hasher,
    pub(super) last_line: LastLine,
    last_line_number: usize,
    strange_comment: Option<(usize, &'static str)>,
    pub(super) cut_rows: usize,
    pub(super) damages: Vec<Damage>,
}

impl Rows {
    /// For the rows below `head`, in a file of so many bytes.
    pub(super) fn new(head: &Head, bytes: usize) -> Self {
        Self {
            reader: RowReader::new(&head.header, head.has_pulse),
            frames_are_whole: head.header.format > 1,
            sound: Vec::with_capacity((bytes / SHORTEST_ROW).min(MOST_SAMPLES as usize)),
            frame: Vec::new(),
            frame_number: None,
            frame_sound: 0,
            seen: 0,
            newest_sample: None,
            digest: crc32fast::Hasher::new(),
            last_line: LastLine::Missing,
            last_line_number: 0,
            strange_comment: None,
            cut_rows: 0,
            damages: Vec::new(),
        }
    }

    /// Judges the last frame and the last comment, when all lines are read.
    pub(super) fn finish(&mut self) {
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
    }

    fn damaged(&mut self, line: usize, reason: &str) {
        self.damages
            .push(Damage::at_row(self.seen + 1, line, reason));
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
            self.take_comment(number, comment, text);
            return;
        }
        self.digest.update(line.bytes);
        self.seen += 1;
        let row = self.reader.read(text).and_then(|row| self.rising(row));
        if self.frames_are_whole {
            self.take_into_frame(number, row);
            return;
        }
        match row {
            Ok(row) => self.sound.push(row),
            Err(reason) => self.damages.push(Damage::at_row(self.seen, number, reason)),
        }
    }

    /// Takes in a comment, which is the last line as a rule; `text` is all of its line.
    fn take_comment(&mut self, number: usize, comment: &[u8], text: &[u8]) {
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

    fn take_into_frame(&mut self, line: usize, row: Result<Row, &'static str>) {
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
        let most = most_common(rows.iter().map(|row| row.pulse));
        let faults = frame.iter().filter_map(|(line, number, row)| {
            let reason = match row {
                Err(reason) => reason,
                Ok(row) if Some(row.pulse) != most => "its pulse is not that of its frame",
                Ok(_) => return None,
            };
            Some(Damage::at_row(*number, *line, reason))
        });
        let before = self.damages.len();
        self.damages.extend(faults);
        let Some((line, number, _)) = frame.last().filter(|_| self.damages.len() == before) else {
            return;
        };
        let first = rows.first().map_or(0, |row| row.sample);
        let begins_a_frame = first.is_multiple_of(SAMPLES_PER_FRAME as u64)
            && (first..)
                .zip(&rows)
                .all(|(sample, row)| row.sample == sample);
        let ends_the_file =
            matches!(self.last_line, LastLine::Missing) && *line == self.last_line_number;
        if begins_a_frame && ends_the_file {
            self.cut_rows = rows.len();
        } else {
            let reason = "rows of its frame are missing";
            self.damages.push(Damage::at_row(*number, *line, reason));
        }
    }
}

/// Line, row number and result.
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

/// The value that is there most often; of equals the one that comes last.
fn most_common<T: PartialEq + Copy>(values: impl Iterator<Item = T> + Clone) -> Option<T> {
    let count = |value: &T| values.clone().filter(|other| other == value).count();
    values.clone().max_by_key(count)
}
