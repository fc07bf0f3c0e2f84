//! Where a recording is written to, and whether that is free.

use super::write_error::{WriteError, WriteFault};
use std::fs::{File, OpenOptions, TryLockError};
use std::io::{Error, Seek, SeekFrom, Sink, Write};
use std::path::{Path, PathBuf};

/// Where a recording is written to: a file, as a rule.
pub trait RecordingTarget: Write + Send {
    /// Takes back everything beyond the first `length` bytes.
    fn cut_to(&mut self, length: u64) -> std::io::Result<()>;

    /// Waits until everything is where a power cut cannot touch it.
    fn settle(&mut self) -> std::io::Result<()>;

    /// Whether these bytes, and no others, are in it, and its name still leads to it. What cannot be read again is believed.
    fn holds(&mut self, _contents: &[u8]) -> std::io::Result<bool> {
        Ok(true)
    }

    /// Saves the contents under a name that is free, after another program has taken the file's name from it or has
    /// changed it; returns that name.
    fn rescue(&mut self, _contents: &[u8]) -> Option<PathBuf> {
        None
    }
}

/// Rows that nobody wants to keep.
impl RecordingTarget for Sink {
    fn cut_to(&mut self, _length: u64) -> std::io::Result<()> {
        Ok(())
    }

    fn settle(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

impl RecordingTarget for File {
    fn cut_to(&mut self, length: u64) -> std::io::Result<()> {
        self.set_len(length)?;
        self.seek(SeekFrom::End(0)).map(|_| ())
    }

    fn settle(&mut self) -> std::io::Result<()> {
        self.sync_all()
    }
}

/// Makes sure that nobody writes to the file.
pub(super) fn require_unlocked(file: &File, path: &Path) -> Result<(), WriteError> {
    match file.try_lock() {
        Err(TryLockError::WouldBlock) => Err(WriteError::at(path)(WriteFault::InUse)),
        _ => Ok(()),
    }
}

/// Makes sure that opening a named pipe will not wait for a reader that may never come.
#[cfg(unix)]
pub(super) fn require_reader(path: &Path) -> Result<(), WriteError> {
    use std::os::unix::fs::{FileTypeExt, OpenOptionsExt};
    if !path
        .metadata()
        .is_ok_and(|there| there.file_type().is_fifo())
    {
        return Ok(());
    }
    let nonblocking = rustix::fs::OFlags::NONBLOCK.bits();
    let opened = OpenOptions::new()
        .write(true)
        .custom_flags(nonblocking.cast_signed())
        .open(path);
    opened.map(|_reader| ()).map_err(|_| {
        WriteError::not_created(path, Error::other("it is a pipe from which nobody reads"))
    })
}

/// Makes sure that opening a named pipe will not wait for a reader that may never come.
#[cfg(not(unix))]
pub(super) fn require_reader(_: &Path) -> Result<(), WriteError> {
    Ok(())
}
