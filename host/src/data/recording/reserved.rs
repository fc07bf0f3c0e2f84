//! Files that recordings go to, and files that are put in place when they are whole.

use super::Header;
use super::WriteError;
use super::writer::{RecordingWriter, Target};
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
        require_reader(path)?;
        let mut options = OpenOptions::new();
        // Read only if it has to be rescued; what is no file may not be readable.
        let is_file = there.as_ref().is_none_or(std::fs::Metadata::is_file);
        options.read(is_file).write(true);
        if force || empty {
            options.create(true).truncate(false)
        } else {
            options.create_new(true)
        };
        let file = options
            .open(path)
            .map_err(|reason| not_created(path, reason))?;
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

    fn rescue(&mut self) -> Option<PathBuf> {
        let (mut file, kept) = free_name(&self.path)?;
        self.file.rewind().ok()?;
        std::io::copy(&mut self.file, &mut file).ok()?;
        file.sync_all().ok()?;
        Some(kept)
    }
}

/// A new file of this name if it is free, or else of one with a number in it.
fn free_name(path: &Path) -> Option<(File, PathBuf)> {
    let stem = path.file_stem()?.to_string_lossy();
    let ending = path.extension().map(|ending| ending.to_string_lossy());
    let numbered = |number: u32| {
        let ending = ending.as_ref().map(|e| format!(".{e}")).unwrap_or_default();
        path.with_file_name(format!("{stem}-rescued-{number}{ending}"))
    };
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
            return Err(WriteError::exists(path));
        }
        let not_created = |reason| not_created(path, reason);
        require_reader(path)?;
        // A recording that is being written must not be put aside. What cannot be read cannot be told.
        if there.as_ref().is_some_and(std::fs::Metadata::is_file)
            && let Ok(running) = File::open(path)
        {
            require_unlocked(&running, path)?;
        }
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
    let aside = builder.tempfile_in(folder.unwrap_or(Path::new(".")));
    // The name of a file that nobody asked for says nothing.
    aside.map_err(|reason| reason.kind().into())
}

/// Makes sure that nobody writes to the file.
fn require_unlocked(file: &File, path: &Path) -> Result<(), WriteError> {
    match file.try_lock() {
        Err(TryLockError::WouldBlock) => Err(WriteError::InUse {
            path: path.to_owned(),
        }),
        _ => Ok(()),
    }
}

/// Makes sure that opening a named pipe will not wait for a reader that may never come.
#[cfg(unix)]
fn require_reader(path: &Path) -> Result<(), WriteError> {
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
    opened
        .map(|_reader| ())
        .map_err(|_| not_created(path, Error::other("it is a pipe from which nobody reads")))
}

/// Makes sure that opening a named pipe will not wait for a reader that may never come.
#[cfg(not(unix))]
fn require_reader(_: &Path) -> Result<(), WriteError> {
    Ok(())
}

fn not_created(path: &Path, reason: Error) -> WriteError {
    match reason.kind() {
        ErrorKind::AlreadyExists | ErrorKind::IsADirectory => WriteError::exists(path),
        ErrorKind::NotFound => WriteError::NoFolder {
            path: path.to_owned(),
        },
        _ => WriteError::NotCreated {
            path: path.to_owned(),
            reason,
        },
    }
}
