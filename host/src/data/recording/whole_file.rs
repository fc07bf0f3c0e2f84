//! Files that are put in place when they are whole.

use super::target::{require_reader, require_unlocked};
use super::write_error::WriteError;
use std::fs::{File, OpenOptions};
use std::io::{Result as IoResult, Write};
use std::path::{Path, PathBuf};
use tempfile::NamedTempFile;

/// A file that takes its place when it is whole: until then an older file stays, and half a file is
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
    /// A pipe or a device cannot be replaced.
    Direct(File),
}

/// Writes a whole file: after an error, the file that was there stays.
///
/// # Errors
/// [`WriteError`], as where the file exists and `force` is not given.
pub fn write_file(path: &Path, force: bool, content: &str) -> Result<(), WriteError> {
    let whole = WholeFile::new(path, force)?;
    let written = whole.file()?.write_all(content.as_bytes());
    written.map_err(|reason| WriteError::not_created(path, reason))?;
    whole.put_in_place()
}

impl WholeFile {
    /// Begins a file beside `path`.
    pub(crate) fn new(path: &Path, force: bool) -> Result<Self, WriteError> {
        let there = path.metadata().ok();
        if there.is_some() && !force {
            return Err(WriteError::exists(path));
        }
        let not_created = |reason| WriteError::not_created(path, reason);
        require_reader(path)?;
        // A recording that is being written must not be put aside. Of a file that cannot be read nobody knows.
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
    pub(crate) fn file(&self) -> Result<File, WriteError> {
        let file = match &self.target {
            Place::Aside(file) => file.as_file(),
            Place::Direct(file) => file,
        };
        file.try_clone()
            .map_err(|reason| WriteError::not_created(&self.path, reason))
    }

    /// Puts it in its place.
    ///
    /// # Errors
    /// [`WriteError`]; an older file is there still.
    pub(crate) fn put_in_place(self) -> Result<(), WriteError> {
        let Place::Aside(file) = self.target else {
            return Ok(());
        };
        let not_created = |reason| WriteError::not_created(&self.path, reason);
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
    // The name of a file that nobody asked for is of no use in an error.
    aside.map_err(|reason| reason.kind().into())
}
