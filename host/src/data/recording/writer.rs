//! Writes a recording so that the frames so far survive the death of this program.

use super::header::Header;
use super::last_line::Ending;
use super::reserved_file::ReservedFile;
use super::row::{COLUMNS, Row};
use super::row_text::{RowTimes, write_row};
use super::target::RecordingTarget;
use super::write_error::{WriteError, WriteFault};
use crate::data::degrees::DegreeScale;
use servoid_protocol::Frame;
use servoid_protocol::timing::SAMPLES_PER_FRAME;
use std::path::{Path, PathBuf};

/// A recording that is being written.
pub struct RecordingWriter {
    target: Box<dyn RecordingTarget>,
    path: PathBuf,
    /// The lines above the rows, until they are written.
    header: Option<String>,
    times: RowTimes,
    scale: DegreeScale,
    /// The header's own CRC, which goes into the check of each row.
    header_crc: String,
    rows: u64,
    /// One past the newest frame in it.
    end: u32,
    /// All that is in the file, up to the last whole frame: what it is compared with at its end.
    contents: Vec<u8>,
    digest: crc32fast::Hasher,
}

impl RecordingWriter {
    /// Makes the file and writes its header.
    pub fn create(path: &Path, force: bool, header: &Header) -> Result<Self, WriteError> {
        let file = Box::new(ReservedFile::new(path, force)?);
        Self::on(file, path, header)
    }

    /// A writer that replaces the contents of `file` with the first frame or the end.
    pub fn begin(file: ReservedFile, header: &Header) -> Self {
        let path = file.path().to_owned();
        Self::waiting(Box::new(file), &path, header)
    }

    /// Writes the header to `target`; `path` is what error texts call it.
    pub fn on(
        target: Box<dyn RecordingTarget>,
        path: &Path,
        header: &Header,
    ) -> Result<Self, WriteError> {
        let mut writer = Self::waiting(target, path, header);
        writer.begin_file()?;
        Ok(writer)
    }

    /// A writer that leaves `target` as it is until the first frame or the end.
    fn waiting(target: Box<dyn RecordingTarget>, path: &Path, header: &Header) -> Self {
        let checked = Header {
            row_checks: true,
            ..header.clone()
        };
        let (lines, header_crc) = checked.to_lines();
        Self {
            target,
            path: path.to_owned(),
            header: Some(format!("{lines}{COLUMNS}\n")),
            header_crc,
            times: RowTimes::under(header),
            scale: DegreeScale::of_recording(header),
            rows: 0,
            end: 0,
            contents: Vec::new(),
            digest: crc32fast::Hasher::new(),
        }
    }

    /// Whether anything of it is in the file; before that, the file is unchanged.
    pub fn has_begun(&self) -> bool {
        self.header.is_none()
    }

    /// Replaces the contents of the file by the lines above the rows, unless that has been done.
    fn begin_file(&mut self) -> Result<(), WriteError> {
        let Some(text) = self.header.take() else {
            return Ok(());
        };
        // A pipe or a device has no length to cut.
        let _best_effort = self.target.cut_to(0);
        self.target.write_all(text.as_bytes()).map_err(|reason| {
            // An empty file is in nobody's way.
            let _best_effort = self.target.cut_to(0);
            WriteError::at(&self.path)(WriteFault::NotCreated(reason))
        })?;
        self.contents = text.into_bytes();
        Ok(())
    }

    /// Where it goes.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Rows so far.
    pub fn rows(&self) -> u64 {
        self.rows
    }

    /// One past the newest frame that is in it.
    pub fn end(&self) -> u32 {
        self.end
    }

    /// Appends a frame's rows. They are the system's when this returns: the death of this program
    /// no longer touches them.
    ///
    /// # Errors
    /// [`WriteFault::Stopped`]; the rows before this frame are kept.
    pub fn append(&mut self, frame: &Frame) -> Result<(), WriteError> {
        self.begin_file()?;
        let mut text = String::with_capacity(SAMPLES_PER_FRAME * 59);
        let first = u64::from(frame.index) * SAMPLES_PER_FRAME as u64;
        for (sample, counts) in (first..).zip(frame.samples) {
            let row = Row {
                sample,
                pulse: frame.pulse,
                counts,
            };
            write_row(&mut text, self.times, &self.scale, &self.header_crc, row);
        }
        // In one piece, so that a program that dies leaves whole frames.
        self.target
            .write_all(text.as_bytes())
            .map_err(|reason| self.stopped(reason))?;
        self.contents.extend(text.as_bytes());
        self.digest.update(text.as_bytes());
        self.rows += SAMPLES_PER_FRAME as u64;
        self.end = u32::from(frame.index) + 1;
        Ok(())
    }

    /// Writes the last line, waits until everything is on the disk, and reads it back.
    ///
    /// # Errors
    /// [`WriteFault::Stopped`]; the rows are kept, and without its last line the recording is read
    /// as partial. [`WriteFault::Rescued`], [`WriteFault::Removed`].
    pub fn finish(self, ending: &Ending) -> Result<(), WriteError> {
        self.close(ending, true)
    }

    /// [`RecordingWriter::finish`], but when it reaches the disk is left to the system: a program that waits for a disk
    /// cannot be ended by anything.
    pub fn finish_in_a_hurry(self, ending: &Ending) -> Result<(), WriteError> {
        self.close(ending, false)
    }

    fn close(mut self, ending: &Ending, waits_for_disk: bool) -> Result<(), WriteError> {
        self.begin_file()?;
        let line = ending.last_line(self.rows, self.digest.clone().finalize());
        let written = self.target.write_all(line.as_bytes());
        written.map_err(|reason| self.stopped(reason))?;
        self.contents.extend(line.as_bytes());
        if waits_for_disk {
            let settled = self.target.settle();
            settled.map_err(|reason| self.stopped(reason))?;
        }
        match self.target.holds(&self.contents) {
            Ok(true) => Ok(()),
            Ok(false) => Err(self.rescued()),
            Err(reason) => Err(self.stopped(reason)),
        }
    }

    fn rescued(&mut self) -> WriteError {
        let rows = self.rows;
        WriteError::at(&self.path)(match self.target.rescue(&self.contents) {
            Some(kept) => WriteFault::Rescued { kept, rows },
            None => WriteFault::Removed(rows),
        })
    }

    fn stopped(&mut self, reason: std::io::Error) -> WriteError {
        // Part of a frame may have got through; if the system cannot take it back, the reader
        // passes over a last line that has no end.
        let _best_effort = self.target.cut_to(self.contents.len() as u64);
        let rows = self.rows;
        WriteError::at(&self.path)(WriteFault::Stopped { rows, reason })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::recording::{Completeness, Recording};
    use servoid_protocol::{Counts, PulseWidth};
    use std::io::{Error, ErrorKind, Result as IoResult, Write};
    use std::sync::{Arc, Mutex};

    /// A disk with room for so many bytes, which takes part of what does not fit.
    #[derive(Clone)]
    struct SmallDisk {
        bytes: Arc<Mutex<Vec<u8>>>,
        room: usize,
        can_cut: bool,
    }

    impl Write for SmallDisk {
        fn write(&mut self, bytes: &[u8]) -> IoResult<usize> {
            let mut disk = self.bytes.lock().unwrap();
            let count = bytes.len().min(self.room - disk.len());
            disk.extend(&bytes[..count]);
            if count == 0 {
                return Err(ErrorKind::StorageFull.into());
            }
            Ok(count)
        }

        fn flush(&mut self) -> IoResult<()> {
            Ok(())
        }
    }

    impl RecordingTarget for SmallDisk {
        fn cut_to(&mut self, length: u64) -> IoResult<()> {
            if !self.can_cut {
                return Err(Error::other("no"));
            }
            self.bytes.lock().unwrap().truncate(length as usize);
            Ok(())
        }

        fn settle(&mut self) -> IoResult<()> {
            Ok(())
        }
    }

    /// Wherever the disk ends, in a row, in a frame or in the last line: what is on it is whole
    /// frames, and the error has the number of their rows.
    #[test]
    fn a_full_disk_keeps_every_whole_frame() {
        for can_cut in [true, false] {
            for room in 800..2_600 {
                let disk = SmallDisk {
                    bytes: Arc::default(),
                    room,
                    can_cut,
                };
                let path = Path::new("x.csv");
                let begun = RecordingWriter::on(Box::new(disk.clone()), path, &Header::default());
                let Ok(mut writer) = begun else { continue };
                let mut index = 0;
                let stopped = loop {
                    let frame = Frame {
                        run: 1,
                        index,
                        pulse: PulseWidth(1_500),
                        samples: [Counts(8_000 + index); SAMPLES_PER_FRAME],
                    };
                    match writer.append(&frame) {
                        Ok(()) => index += 1,
                        Err(error) => break error,
                    }
                };
                let closed = writer.finish(&Ending::Complete);
                let recording = Recording::parse(&disk.bytes.lock().unwrap(), path).unwrap();
                let rows = recording.rows.len() as u64;
                assert_eq!(rows, u64::from(index) * 10, "{room}");
                let matches =
                    matches!(stopped.fault, WriteFault::Stopped { rows: r, .. } if r == rows);
                assert!(matches, "{stopped}");
                // The room that the frame did not need may be enough for the last line.
                if closed.is_err() || !can_cut {
                    assert!(matches!(recording.completeness, Completeness::Partial(_)));
                }
            }
        }
    }
}
