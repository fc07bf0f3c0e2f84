//! The rows of one run: what was written, and what is missing in between.

use super::capture_outcome::Progress;
use crate::data::recording::{RecordingWriter, WriteError};
use servoid_client::Client;
use servoid_protocol::Frame;
use std::ops::Range;

/// Writes the frames of one run.
pub(super) struct RunRows<'a> {
    pub(super) writer: RecordingWriter,
    on_progress: &'a mut dyn FnMut(Progress<'_>),
    frames_total: u32,
    /// One past the newest frame that is in the file.
    written: u32,
    /// Frames that are missing before it.
    lost: Vec<Range<u32>>,
}

impl<'a> RunRows<'a> {
    /// Rows of a run of so many frames.
    pub(super) fn new(
        writer: RecordingWriter,
        frames_total: u32,
        on_progress: &'a mut dyn FnMut(Progress<'_>),
    ) -> Self {
        Self {
            writer,
            on_progress,
            frames_total,
            written: 0,
            lost: Vec::new(),
        }
    }

    /// Writes the next frame; those between it and the one before are lost.
    pub(super) fn write(&mut self, frame: &Frame, client: &Client) -> Result<(), WriteError> {
        let index = u32::from(frame.index);
        if self.written < index {
            self.lost.push(self.written..index);
        }
        self.writer.append(frame)?;
        self.written = index + 1;
        (self.on_progress)(Progress {
            frame,
            frames_total: self.frames_total,
            rejects: client.rejects(),
            asked_again: client.frames_asked_again(),
            lost: self.lost.iter().map(|gap| gap.end - gap.start).sum(),
            status: client.status(),
        });
        Ok(())
    }

    /// Every frame that is missing, with those that the run would still have had.
    pub(super) fn missing(&self) -> Vec<Range<u32>> {
        let mut missing = self.lost.clone();
        match missing.last_mut() {
            // A frame behind it came and could not be written.
            Some(last) if last.end > self.written => last.end = self.frames_total,
            _ if self.written < self.frames_total => missing.push(self.written..self.frames_total),
            _ => {}
        }
        missing
    }
}
