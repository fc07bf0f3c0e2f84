//! Files that recordings go to, and files that are put in place when they are whole.

use super::Header;
use super::writer::{RecordingWriter, Target, WriteError};
use std::fs::{File, OpenOptions, TryLockError};
use std::io::{Error, ErrorKind, Result as IoResult, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use tempfile::NamedTempFile;

impl Target for File {
    fn cut_to(&mut self, length: u64) -> IoResult<()> {
        self.set_len(length)?;
        self.seek(SeekFrom::End(0)).map(|_| ())
    }

    fn settle(&mut self) -> IoResult<()> {
        self.sync_all()
    }
}

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
    /// [`WriteError::Exists`] unless `force`; [`WriteError::InUse`]; [`WriteError::NotCreated`].
    pub fn new(path: &Path, force: bool) -> Result<Self, WriteError> {
        let there = path.metadata().ok();
        let empty = there
            .as_ref()
            .is_some_and(|there| there.is_file() && there.len() == 0);
        let mut options = OpenOptions::new();
        options.write(true);
        if force || empty {
            options.create(true).truncate(false)
        } else {
            options.create_new(true)
        };
        let file = options
            .open(path)
            .map_err(|reason| not_created(path, reason))?;
        let plain = file.metadata().is_ok_and(|file| file.is_file());
        if plain && matches!(file.try_lock(), Err(TryLockError::WouldBlock)) {
            return Err(WriteError::InUse {
                path: path.to_owned(),
            });
        }
        Ok(Self {
            file,
            path: path.to_owned(),
            plain,
            made_for_nothing: plain && there.is_none(),
        })
    }

    /// A recording with this header, which replaces what is in the file with its first frame.
    ///
    /// # Errors
    /// [`WriteError::NotCreated`].
    pub fn begin(self, header: &Header) -> Result<RecordingWriter, WriteError> {
        let path = self.path.clone();
        RecordingWriter::waiting(Box::new(self), &path, header)
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

impl Target for ReservedFile {
    fn cut_to(&mut self, length: u64) -> IoResult<()> {
        if self.plain {
            self.file.cut_to(length)
        } else {
            Ok(())
        }
    }

    fn settle(&mut self) -> IoResult<()> {
        if !self.plain {
            return Ok(());
        }
        self.file.settle()?;
        if self.is_in_place() {
            Ok(())
        } else {
            Err(Error::from(ErrorKind::NotFound))
        }
    }
}

impl Drop for ReservedFile {
    /// An empty file would only be a riddle.
    fn drop(&mut self) {
        if self.made_for_nothing {
            let _best_effort = std::fs::remove_file(&self.path);
        }
    }
}

/// A file that takes its place when it is whole: until then what was there stays, and half a file is
/// never seen.
#[derive(Debug)]
pub(crate) struct WholeFile {
    target: Place,
    path: PathBuf,
    force: bool,
}

#[derive(Debug)]
enum Place {
    Aside(NamedTempFile),
    /// What is no plain file, such as a pipe, cannot be replaced.
    Direct(File),
}

impl WholeFile {
    /// Begins a file beside `path`.
    ///
    /// # Errors
    /// [`WriteError::Exists`] unless `force`; [`WriteError::NotCreated`].
    pub(crate) fn new(path: &Path, force: bool) -> Result<Self, WriteError> {
        let there = path.metadata().ok();
        if there.is_some() && !force {
            return Err(WriteError::Exists {
                path: path.to_owned(),
            });
        }
        let not_created = |reason| not_created(path, reason);
        let target = match &there {
            Some(there) if !there.is_file() => Place::Direct(
                OpenOptions::new()
                    .write(true)
                    .open(path)
                    .map_err(not_created)?,
            ),
            _ => Place::Aside(beside(path).map_err(not_created)?),
        };
        // A link stays a link, to the new file.
        let path = path.canonicalize().unwrap_or_else(|_| path.to_owned());
        Ok(Self {
            target,
            path,
            force,
        })
    }

    /// What to write to.
    ///
    /// # Errors
    /// [`WriteError::NotCreated`].
    pub(crate) fn file(&self) -> Result<File, WriteError> {
        let file = match &self.target {
            Place::Aside(file) => file.as_file(),
            Place::Direct(file) => file,
        };
        file.try_clone()
            .map_err(|reason| not_created(&self.path, reason))
    }

    /// Puts it in its place.
    ///
    /// # Errors
    /// [`WriteError`]; what was there is there still.
    pub(crate) fn put_in_place(self) -> Result<(), WriteError> {
        let Place::Aside(file) = self.target else {
            return Ok(());
        };
        let not_created = |reason| not_created(&self.path, reason);
        file.as_file().sync_all().map_err(not_created)?;
        let put = if self.force {
            file.persist(&self.path)
        } else {
            file.persist_noclobber(&self.path)
        };
        put.map(|_file| ())
            .map_err(|error| not_created(error.error))
    }
}

/// A file that is gone again unless it is put in place, on the disk of `path`.
fn beside(path: &Path) -> IoResult<NamedTempFile> {
    let folder = path.canonicalize().ok().or_else(|| Some(path.to_owned()));
    let folder = folder.as_deref().and_then(Path::parent);
    let folder = folder.filter(|folder| !folder.as_os_str().is_empty());
    let mut builder = tempfile::Builder::new();
    builder.prefix(".servoid-");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // As of every other file, with the user's mask taken off; those of a file that is replaced.
        let new = std::fs::Permissions::from_mode(0o666);
        let permissions = path.metadata().map_or(new, |there| there.permissions());
        builder.permissions(permissions);
    }
    builder.tempfile_in(folder.unwrap_or(Path::new(".")))
}

fn not_created(path: &Path, reason: Error) -> WriteError {
    let path = path.to_owned();
    match reason.kind() {
        ErrorKind::AlreadyExists => WriteError::Exists { path },
        _ => WriteError::NotCreated { path, reason },
    }
}
