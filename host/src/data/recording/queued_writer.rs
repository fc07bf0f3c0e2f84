//! A recording that is written by a thread of its own, so that no file system holds up the run.
//!
//! Frames wait in memory for as long as the disk takes none; a run has at most 65 536 of them, of some 30 bytes each.

use super::last_line::Ending;
use super::write_error::WriteError;
use super::writer::RecordingWriter;
use servoid_protocol::Frame;
use servoid_protocol::timing::SAMPLES_PER_FRAME;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread::JoinHandle;

/// What the thread gives back: the writer, and the error that ended it before its queue did.
type Written = (RecordingWriter, Option<WriteError>);

/// Writes a recording behind a queue.
pub struct QueuedWriter {
    state: WriterState,
    frames: u64,
    has_begun: bool,
}

enum WriterState {
    Writing {
        queue: Sender<Frame>,
        thread: JoinHandle<Written>,
    },
    /// The thread has ended: all is written, or the error has been reported.
    Written(RecordingWriter),
    /// The recording is closed.
    Gone,
}

impl QueuedWriter {
    /// Begins the thread.
    pub fn new(writer: RecordingWriter) -> Self {
        let (queue, frames) = channel();
        let has_begun = writer.has_begun();
        let thread = std::thread::spawn(move || write_all(writer, &frames));
        Self {
            state: WriterState::Writing { queue, thread },
            frames: 0,
            has_begun,
        }
    }

    /// Rows that were handed over so far.
    pub fn rows(&self) -> u64 {
        self.frames * SAMPLES_PER_FRAME as u64
    }

    /// Whether anything of it is in the file, or will be.
    pub fn has_begun(&self) -> bool {
        self.has_begun
    }

    /// Hands over a frame; never waits for the disk.
    ///
    /// # Errors
    /// Of a frame before it, as [`RecordingWriter::append`] has them.
    pub fn append(&mut self, frame: &Frame) -> Result<(), WriteError> {
        self.check()?;
        if let WriterState::Writing { queue, .. } = &self.state
            && queue.send(*frame).is_ok()
        {
            self.frames += 1;
            self.has_begun = true;
        }
        self.check()
    }

    /// Whether all is well so far.
    ///
    /// # Errors
    /// Once, as [`RecordingWriter::append`] has them.
    pub fn check(&mut self) -> Result<(), WriteError> {
        // The thread ends by itself only where it has failed.
        if matches!(&self.state, WriterState::Writing { thread, .. } if thread.is_finished()) {
            return self.drain();
        }
        Ok(())
    }

    /// One past the newest frame that is in the file, once it is drained.
    pub fn end(&self) -> u32 {
        match &self.state {
            WriterState::Written(writer) => writer.end(),
            WriterState::Writing { .. } | WriterState::Gone => 0,
        }
    }

    /// Closes the file, whatever became of its frames.
    ///
    /// # Errors
    /// As [`RecordingWriter::finish`].
    pub fn finish(self, ending: &Ending) -> Result<(), WriteError> {
        self.close(|writer| writer.finish(ending))
    }

    /// Closes the file without waiting for the disk.
    ///
    /// # Errors
    /// As [`RecordingWriter::finish_in_a_hurry`].
    pub fn finish_in_a_hurry(self, ending: &Ending) -> Result<(), WriteError> {
        self.close(|writer| writer.finish_in_a_hurry(ending))
    }

    fn close(
        mut self,
        finish: impl FnOnce(RecordingWriter) -> Result<(), WriteError>,
    ) -> Result<(), WriteError> {
        let written = self.drain();
        let closed = match std::mem::replace(&mut self.state, WriterState::Gone) {
            WriterState::Written(writer) => finish(writer),
            WriterState::Writing { .. } | WriterState::Gone => Ok(()),
        };
        written.and(closed)
    }

    /// Waits until the frames are written, unless the thread has ended before.
    ///
    /// # Errors
    /// As [`QueuedWriter::check`].
    pub fn drain(&mut self) -> Result<(), WriteError> {
        let (queue, thread) = match std::mem::replace(&mut self.state, WriterState::Gone) {
            WriterState::Writing { queue, thread } => (queue, thread),
            other => {
                self.state = other;
                return Ok(());
            }
        };
        drop(queue);
        match thread.join() {
            Ok((writer, error)) => {
                self.state = WriterState::Written(writer);
                error.map_or(Ok(()), Err)
            }
            Err(panic) => std::panic::resume_unwind(panic),
        }
    }
}

impl Drop for QueuedWriter {
    /// A file that was reserved for nothing is removed before this program ends.
    fn drop(&mut self) {
        let _nobody_asks_any_more = self.drain();
    }
}

fn write_all(mut writer: RecordingWriter, frames: &Receiver<Frame>) -> Written {
    while let Ok(frame) = frames.recv() {
        if let Err(error) = writer.append(&frame) {
            return (writer, Some(error));
        }
    }
    (writer, None)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::recording::{Completeness, Header, Recording, RecordingTarget};
    use servoid_protocol::{Counts, PulseWidth};
    use std::io::{Result as IoResult, Write};
    use std::path::Path;
    use std::sync::atomic::{AtomicBool, Ordering};
    use std::sync::{Arc, Mutex};

    /// A file system that takes nothing for as long as the test holds its lock.
    #[derive(Clone, Default)]
    struct Stalling {
        stalled: Arc<Mutex<()>>,
        bytes: Arc<Mutex<Vec<u8>>>,
        waited: Arc<AtomicBool>,
    }

    impl Write for Stalling {
        fn write(&mut self, bytes: &[u8]) -> IoResult<usize> {
            let _waits = self.stalled.lock().unwrap();
            self.bytes.lock().unwrap().extend(bytes);
            Ok(bytes.len())
        }

        fn flush(&mut self) -> IoResult<()> {
            Ok(())
        }
    }

    impl RecordingTarget for Stalling {
        fn cut_to(&mut self, _length: u64) -> IoResult<()> {
            Ok(())
        }

        fn settle(&mut self) -> IoResult<()> {
            self.waited.store(true, Ordering::SeqCst);
            Ok(())
        }
    }

    /// All frames are handed over while the disk takes none of them: were one waited for, this would never end.
    #[test]
    fn a_file_system_that_stalls_holds_nobody_up_and_costs_no_row() {
        const FRAMES: u16 = 3_000;
        let (disk, path) = (Stalling::default(), Path::new("x.csv"));
        let header = Header::default();
        let writer = RecordingWriter::on(Box::new(disk.clone()), path, &header).unwrap();
        let mut queue = QueuedWriter::new(writer);
        let stalls = disk.stalled.lock().unwrap();
        for index in 0..FRAMES {
            let frame = Frame {
                run: 1,
                index,
                pulse: PulseWidth(1_500),
                samples: [Counts(8_000 + index); SAMPLES_PER_FRAME],
            };
            queue.append(&frame).unwrap();
        }
        drop(stalls);
        queue.drain().unwrap();
        assert_eq!(queue.end(), u32::from(FRAMES));
        queue.finish(&Ending::Complete).unwrap();
        let recording = Recording::parse(&disk.bytes.lock().unwrap(), path).unwrap();
        assert_eq!(recording.completeness, Completeness::Complete);
        assert_eq!(
            recording.rows.len(),
            usize::from(FRAMES) * SAMPLES_PER_FRAME
        );
    }
    /// A thread that waits for a disk is ended by no signal, and its program neither.
    #[test]
    fn a_file_that_is_closed_in_a_hurry_does_not_wait_for_the_disk() {
        for hurried in [true, false] {
            let (disk, path) = (Stalling::default(), Path::new("x.csv"));
            let target = Box::new(disk.clone());
            let writer = RecordingWriter::on(target, path, &Header::default()).unwrap();
            let (queue, ending) = (QueuedWriter::new(writer), Ending::Complete);
            match hurried {
                true => queue.finish_in_a_hurry(&ending).unwrap(),
                false => queue.finish(&ending).unwrap(),
            }
            assert_eq!(disk.waited.load(Ordering::SeqCst), !hurried);
            let recording = Recording::parse(&disk.bytes.lock().unwrap(), path).unwrap();
            assert_eq!(recording.completeness, Completeness::Complete);
        }
    }
}
