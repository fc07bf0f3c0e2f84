//! Writing a recording so that what has been captured survives whatever comes next.

use super::{COLUMNS, Header};
use servoid_protocol::framing::CRC;
use servoid_protocol::timing::{SAMPLE_US, SAMPLES_PER_FRAME};
use servoid_protocol::{Frame, SensorScale, ServoScale};
use std::fmt::Write as _;
use std::fs::{File, OpenOptions};
use std::io::Write as _;
use std::ops::Range;
use std::path::{Path, PathBuf};

/// Why a recording could not be written. The text says what to do.
#[derive(Debug, thiserror::Error)]
pub enum WriteError {
    /// The target is there already.
    #[error("{path:?} exists already: choose another name, or add --force to replace it")]
    Exists {
        /// Which.
        path: PathBuf,
    },
    /// The file cannot be made.
    #[error("{path:?} cannot be written: {reason}")]
    NotCreated {
        /// Which.
        path: PathBuf,
        /// What the system said.
        reason: std::io::Error,
    },
    /// The disk is full or gone.
    #[error("{path:?} could not be written on ({reason}): the {rows} rows so far are kept")]
    Stopped {
        /// Which.
        path: PathBuf,
        /// Rows that are on the disk.
        rows: u64,
        /// What the system said.
        reason: std::io::Error,
    },
}

/// How a recording ends.
#[derive(Clone, Debug, PartialEq)]
pub enum Ending {
    /// Every sample of the run is in it, proved by the rig's own check.
    Complete,
    /// Something is missing, or the run was cut short.
    Partial {
        /// Why, in plain words.
        reason: String,
        /// Frames of which nothing came.
        lost_frames: Vec<Range<u32>>,
    },
}

/// Opens a file for writing that was not there, or whose loss is allowed.
pub(crate) fn create(path: &Path, force: bool) -> Result<File, WriteError> {
    let mut options = OpenOptions::new();
    options.write(true);
    if force {
        options.create(true).truncate(true)
    } else {
        options.create_new(true)
    };
    options.open(path).map_err(|reason| match reason.kind() {
        std::io::ErrorKind::AlreadyExists => WriteError::Exists {
            path: path.to_owned(),
        },
        _ => WriteError::NotCreated {
            path: path.to_owned(),
            reason,
        },
    })
}

/// A recording that is being written.
pub struct RecordingWriter {
    file: File,
    path: PathBuf,
    servo: ServoScale,
    sensor: SensorScale,
    rows: u64,
    /// Length of the file up to the last whole frame (bytes).
    bytes: u64,
    digest: crc::Digest<'static, u32, crc::Table<1>>,
}

impl RecordingWriter {
    /// Makes the file and writes its header.
    ///
    /// # Errors
    /// [`WriteError`].
    pub fn create(
        path: &Path,
        force: bool,
        header: &Header,
        servo: ServoScale,
        sensor: SensorScale,
    ) -> Result<Self, WriteError> {
        let not_created = |reason| WriteError::NotCreated {
            path: path.to_owned(),
            reason,
        };
        let mut text = header
            .to_lines()
            .map_err(|e| not_created(std::io::Error::other(e)))?;
        text.push_str(&COLUMNS.join(","));
        text.push('\n');
        let mut file = create(path, force)?;
        file.write_all(text.as_bytes()).map_err(not_created)?;
        let (path, bytes) = (path.to_owned(), text.len() as u64);
        Ok(Self {
            file,
            path,
            servo,
            sensor,
            rows: 0,
            bytes,
            digest: CRC.digest(),
        })
    }

    /// Where it goes.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Rows so far.
    #[must_use]
    pub fn rows(&self) -> u64 {
        self.rows
    }

    /// Appends a frame's rows. They are the system's when this returns: the death of this program
    /// no longer touches them.
    ///
    /// # Errors
    /// [`WriteError::Stopped`]; the rows before this frame are kept.
    pub fn append(&mut self, frame: &Frame) -> Result<(), WriteError> {
        let mut text = String::with_capacity(SAMPLES_PER_FRAME * 40);
        let reference = self.servo.degrees(frame.pulse).0;
        let first = u64::from(frame.index) * SAMPLES_PER_FRAME as u64;
        for (sample, counts) in (first..).zip(frame.samples) {
            // Whole microseconds, so that no row's time carries a rounding of its own.
            let time_us = sample * u64::from(SAMPLE_US);
            let position = self.sensor.degrees(counts).0;
            let _infallible = writeln!(
                text,
                "{sample},{}.{:03},{reference},{position:.4},{}",
                time_us / 1_000_000,
                time_us % 1_000_000 / 1000,
                counts.0
            );
        }
        self.file
            .write_all(text.as_bytes())
            .map_err(|reason| self.stopped(reason))?;
        self.bytes += text.len() as u64;
        self.digest.update(text.as_bytes());
        self.rows += SAMPLES_PER_FRAME as u64;
        Ok(())
    }

    /// Writes the last line and waits until everything is on the disk.
    ///
    /// # Errors
    /// [`WriteError::Stopped`]; the rows are kept, and without its last line the recording is read
    /// as partial.
    pub fn finish(mut self, ending: &Ending) -> Result<(), WriteError> {
        let crc32 = self.digest.clone().finalize();
        let rows = self.rows;
        let line = match ending {
            Ending::Complete => {
                format!("# end = \"complete\", rows = {rows}, crc32 = \"{crc32:08x}\"\n")
            }
            Ending::Partial {
                reason,
                lost_frames,
            } => {
                let reason = toml::Value::from(reason.as_str());
                let samples = SAMPLES_PER_FRAME as u32;
                let lost: Vec<_> = lost_frames
                    .iter()
                    .map(|f| format!("[{}, {}]", f.start * samples, f.end * samples - 1))
                    .collect();
                format!(
                    "# end = \"partial\", rows = {rows}, crc32 = \"{crc32:08x}\", reason = {reason}, lost_samples = [{}]\n",
                    lost.join(", ")
                )
            }
        };
        let written = self
            .file
            .write_all(line.as_bytes())
            .and_then(|()| self.file.sync_all());
        written.map_err(|reason| self.stopped(reason))
    }

    fn stopped(&self, reason: std::io::Error) -> WriteError {
        // Part of a frame may have got through; if the system cannot take it back, the reader
        // passes over a last line that has no end.
        let _best_effort = self.file.set_len(self.bytes);
        WriteError::Stopped {
            path: self.path.clone(),
            rows: self.rows,
            reason,
        }
    }
}
