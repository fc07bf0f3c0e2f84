//! Rows, checked against their own frame and against those before them.

use super::comment::comment_table;
use super::damage::Damage;
use super::head::Head;
use crate::data::recording::last_line::LastLine;
use crate::data::recording::row::Row;
use crate::data::recording::row_text::RowReader;
use servoid_protocol::timing::SAMPLES_PER_FRAME;

/// The end of a file, where the last line belongs.
#[derive(Debug)]
pub(in crate::data::recording) enum LastLineFound {
    /// Nothing, or only a part of one.
    Missing,
    /// Something else.
    Damaged,
    /// A last line.
    Read(LastLine),
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
    pub(super) end: LastLineFound,
    last_line_number: usize,
    strange_comment: Option<(usize, &'static str)>,
    pub(super) cut_rows: usize,
    pub(super) damages: Vec<Damage>,
}

/// Line, row number and result.
type FrameRow = (usize, usize, Result<Row, &'static str>);

impl Rows {
    /// For the rows below `head`.
    pub(super) fn new(head: &Head) -> Self {
        Self {
            reader: RowReader::new(&head.header, head.columns, head.crc.clone()),
            frames_are_whole: head.header.format > 1,
            sound: Vec::new(),
            frame: Vec::new(),
            frame_number: None,
            frame_sound: 0,
            seen: 0,
            newest_sample: None,
            digest: crc32fast::Hasher::new(),
            end: LastLineFound::Missing,
            last_line_number: 0,
            strange_comment: None,
            cut_rows: 0,
            damages: Vec::new(),
        }
    }

    /// Judges the last frame and the last comment, when all lines are read.
    pub(super) fn finish(&mut self) {
        self.check_frame();
        if let Some((number, reason)) = self.strange_comment.take() {
            // In its last place a comment that cannot be read is the last line, damaged.
            if number == self.last_line_number {
                self.end = LastLineFound::Damaged;
            } else {
                self.damaged(self.seen + 1, number, reason);
            }
        }
    }

    fn damaged(&mut self, row: usize, line: usize, reason: &str) {
        self.damages.push(Damage {
            row: Some(row),
            line,
            reason: reason.to_owned(),
        });
    }

    /// Reads the next line.
    pub(super) fn read(&mut self, number: usize, line: &[u8]) {
        self.last_line_number = number;
        if let Some((number, reason)) = self.strange_comment.take() {
            self.damaged(self.seen + 1, number, reason);
        }
        if !matches!(self.end, LastLineFound::Missing) {
            self.damaged(self.seen + 1, number, "something follows the last line");
            return;
        }
        let text = line.trim_ascii_end();
        if let Some(comment) = text.strip_prefix(b"#") {
            self.read_comment(number, comment, text);
            return;
        }
        self.digest.update(line);
        self.seen += 1;
        let row = self.reader.read(text).and_then(|row| self.rising(row));
        match row {
            _ if self.frames_are_whole => self.add_to_frame(number, row),
            Ok(row) => self.sound.push(row),
            Err(reason) => self.damaged(self.seen, number, reason),
        }
    }

    /// Reads a comment, which is the last line as a rule; `text` is all of its line.
    fn read_comment(&mut self, number: usize, comment: &[u8], text: &[u8]) {
        match comment_table(comment) {
            Ok(end) if end.contains_key("end") => {
                self.end =
                    LastLine::read(end, text).map_or(LastLineFound::Damaged, LastLineFound::Read);
            }
            Ok(_) if !self.frames_are_whole => {}
            Ok(_) => self.strange_comment = Some((number, "no comment belongs here")),
            Err(reason) => self.strange_comment = Some((number, reason)),
        }
    }

    fn rising(&mut self, row: Row) -> Result<Row, &'static str> {
        if self.newest_sample >= Some(row.sample) {
            return Err("the sample number does not rise");
        }
        self.newest_sample = Some(row.sample);
        Ok(row)
    }

    fn add_to_frame(&mut self, line: usize, row: Result<Row, &'static str>) {
        let number = row.ok().map(|row| row.sample / SAMPLES_PER_FRAME as u64);
        let another = number.is_some() && self.frame_number.is_some_and(|n| Some(n) != number);
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
        let frame = std::mem::take(&mut self.frame);
        (self.frame_number, self.frame_sound) = (None, 0);
        let Some(&(line, number, _)) = frame.last() else {
            return;
        };
        let rows: Vec<Row> = frame.iter().filter_map(|(_, _, row)| row.ok()).collect();
        let before = self.damages.len();
        let pulse = most_common(rows.iter().map(|row| row.pulse));
        for (line, number, row) in frame {
            match row {
                Err(reason) => self.damaged(number, line, reason),
                Ok(row) if Some(row.pulse) == pulse => {}
                Ok(_) => self.damaged(number, line, "its pulse is not that of its frame"),
            }
        }
        if self.damages.len() > before {
            return;
        }
        let first = rows.first().map_or(0, |row| row.sample);
        let begins_a_frame = first.is_multiple_of(SAMPLES_PER_FRAME as u64)
            && (first..)
                .zip(&rows)
                .all(|(sample, row)| row.sample == sample);
        let ends_the_file =
            matches!(self.end, LastLineFound::Missing) && line == self.last_line_number;
        if begins_a_frame && rows.len() == SAMPLES_PER_FRAME {
            self.sound.extend(rows);
        } else if begins_a_frame && ends_the_file {
            self.cut_rows = rows.len();
        } else {
            self.damaged(number, line, "rows of its frame are missing");
        }
    }
}

/// The value that is there most often; of equals the one that comes last.
fn most_common<T: PartialEq + Copy>(values: impl Iterator<Item = T> + Clone) -> Option<T> {
    let count = |value: &T| values.clone().filter(|other| other == value).count();
    values.clone().max_by_key(count)
}
