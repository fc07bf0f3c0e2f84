//! The file that a recording goes to, reserved before the servo moves.

use super::target::{RecordingTarget, require_reader, require_unlocked};
use super::write_error::WriteError;
use crate::data::numbered_path::with_suffix;
use std::fs::{File, OpenOptions};
use std::io::{Read, Result as IoResult, Seek, Write};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// A file that can be written, belongs to this program alone, and has not been touched yet: so that
/// a folder that is read-only is found before the servo moves, and a file that may be replaced is
/// not lost for a run that does not take place.
#[derive(Debug)]
pub struct ReservedFile {
    file: File,
    path: PathBuf,
    /// A file that is none, such as `/dev/null`, has no length, no lock and nothing to wait for.
    plain: bool,
    /// It was not there before, and nothing is in it.
    made_for_nothing: bool,
}

impl ReservedFile {
    /// Opens the file, or makes it where it is not there. An empty file is nobody's loss.
    ///
    /// # Errors
    /// [`WriteFault::Exists`](super::WriteFault::Exists) unless `force`.
    pub fn new(path: &Path, force: bool) -> Result<Self, WriteError> {
        let there = path.metadata().ok();
        let empty = there
            .as_ref()
            .is_some_and(|there| there.is_file() && there.len() == 0);
        require_reader(path)?;
        let mut options = OpenOptions::new();
        // Read again at the end; a pipe or a device may not be readable.
        let is_file = there.as_ref().is_none_or(std::fs::Metadata::is_file);
        options.read(is_file).write(true);
        if force || empty {
            options.create(true).truncate(false)
        } else {
            options.create_new(true)
        };
        let file = options
            .open(path)
            .map_err(|reason| WriteError::not_created(path, reason))?;
        let plain = file.metadata().is_ok_and(|file| file.is_file());
        if plain {
            require_unlocked(&file, path)?;
        }
        Ok(Self {
            file,
            path: path.to_owned(),
            plain,
            made_for_nothing: plain && there.is_none(),
        })
    }

    /// Where it is.
    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    /// Whether the path still leads to this file.
    #[cfg(unix)]
    fn is_in_place(&self) -> bool {
        use std::os::unix::fs::MetadataExt;
        let identity = |file: std::fs::Metadata| (file.dev(), file.ino());
        match (self.file.metadata(), self.path.metadata()) {
            (Ok(own), Ok(there)) => identity(own) == identity(there),
            _ => false,
        }
    }

    /// Whether the path still leads to this file.
    #[cfg(not(unix))]
    fn is_in_place(&self) -> bool {
        self.path.exists()
    }
}

impl Write for ReservedFile {
    fn write(&mut self, bytes: &[u8]) -> IoResult<usize> {
        let written = self.file.write(bytes)?;
        self.made_for_nothing &= written == 0;
        Ok(written)
    }

    fn flush(&mut self) -> IoResult<()> {
        self.file.flush()
    }
}

impl RecordingTarget for ReservedFile {
    fn cut_to(&mut self, length: u64) -> IoResult<()> {
        if self.plain {
            self.file.cut_to(length)
        } else {
            Ok(())
        }
    }

    fn settle(&mut self) -> IoResult<()> {
        match self.plain {
            true => reach_the_disk(&self.file, &self.path),
            false => Ok(()),
        }
    }

    fn holds(&mut self, contents: &[u8]) -> IoResult<bool> {
        if !self.plain {
            return Ok(true);
        }
        if !self.is_in_place() {
            return Ok(false);
        }
        self.file.rewind()?;
        let mut there = Vec::with_capacity(contents.len());
        // One byte more than there should be: the file of another program may be of any length.
        let most = contents.len() as u64 + 1;
        Read::by_ref(&mut self.file)
            .take(most)
            .read_to_end(&mut there)?;
        Ok(there == contents)
    }

    fn rescue(&mut self, contents: &[u8]) -> Option<PathBuf> {
        let (mut file, kept) = free_name(&self.path)?;
        file.write_all(contents).ok()?;
        reach_the_disk(&file, &kept).ok()?;
        Some(kept)
    }
}

/// Waits until a file is on the disk. No signal ends a program that waits for a disk, and a capture has to end when it is
/// asked to: so another program waits where there is one, and this one for it.
fn reach_the_disk(file: &File, path: &Path) -> IoResult<()> {
    let mut sync = Command::new("sync");
    sync.arg("--").arg(path).stdin(Stdio::null());
    let waited = sync.stdout(Stdio::null()).stderr(Stdio::null()).status();
    match waited {
        Ok(status) if status.success() => Ok(()),
        // Ctrl-C has ended it: the rest is the system's.
        Ok(status) if status.code().is_none() => Ok(()),
        _ => file.sync_all(),
    }
}

/// A new file of this name if it is free, or else of one with a number in it.
fn free_name(path: &Path) -> Option<(File, PathBuf)> {
    let numbered = |number: u32| with_suffix(path, &format!("-rescued-{number}"));
    std::iter::once(path.to_owned())
        .chain((1..100).map(numbered))
        .find_map(|free| File::create_new(&free).ok().map(|file| (file, free)))
}

impl Drop for ReservedFile {
    /// An empty file would only be a riddle.
    fn drop(&mut self) {
        if self.made_for_nothing {
            let _best_effort = std::fs::remove_file(&self.path);
        }
    }
}
