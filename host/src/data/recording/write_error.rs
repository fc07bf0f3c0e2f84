//! Why a file could not be written.

use crate::data::file_error::FileError;
use std::io::{Error, ErrorKind};
use std::path::{Path, PathBuf};

/// Why a file could not be written.
pub type WriteError = FileError<WriteFault>;

/// What keeps a file from being written.
#[derive(Debug, thiserror::Error)]
pub enum WriteFault {
    /// It is there already.
    #[error("exists already: choose another name, or add --force to replace it")]
    Exists,
    /// The command reads it.
    #[error("is what the command reads, and would be replaced by the result: choose another name")]
    IsInput,
    /// It is a folder.
    #[error("is a folder: give the name of a file in it")]
    Folder,
    /// Its folder is not there.
    #[error("cannot be written: its folder is not there; make it first")]
    NoFolder,
    /// It cannot be made.
    #[error("cannot be written: {0}")]
    NotCreated(Error),
    /// Another program writes to it.
    #[error("is being written by another program: wait for its end, or choose another name")]
    InUse,
    /// The file had no name any more, or other contents, and the recording has got another name.
    #[error(
        "was removed, replaced or changed by another program while it was written: all of its {rows} rows are in {kept:?}"
    )]
    Rescued {
        /// Where it is.
        kept: PathBuf,
        /// Rows that are in it.
        rows: u64,
    },
    /// The file, in which so many rows were, has no name any more, or other contents.
    #[error(
        "was removed, replaced or changed by another program while it was written: its {0} rows could not be saved elsewhere"
    )]
    Removed(u64),
    /// The disk is full or gone.
    #[error("could not be written on ({reason}): the {rows} rows so far are kept")]
    Stopped {
        /// Rows that are on the disk.
        rows: u64,
        /// The error of the system.
        reason: Error,
    },
}

impl WriteFault {
    /// Rows of the recording that are on the disk in spite of it.
    pub fn rows_kept(&self) -> u64 {
        match self {
            Self::Rescued { rows, .. } | Self::Stopped { rows, .. } => *rows,
            Self::Exists
            | Self::IsInput
            | Self::Folder
            | Self::NoFolder
            | Self::NotCreated(_)
            | Self::InUse
            | Self::Removed(_) => 0,
        }
    }
}

impl WriteError {
    /// That `path` is there already.
    pub(crate) fn exists(path: &Path) -> Self {
        Self::at(path)(match path.is_dir() {
            true => WriteFault::Folder,
            false => WriteFault::Exists,
        })
    }

    /// That `path` is read by the command that would write it.
    pub(crate) fn is_input(path: &Path) -> Self {
        Self::at(path)(WriteFault::IsInput)
    }

    /// That the folder of `path` is not there.
    pub(crate) fn no_folder(path: &Path) -> Self {
        Self::at(path)(WriteFault::NoFolder)
    }

    /// That `path` cannot be made, and why.
    pub(crate) fn not_created(path: &Path, reason: Error) -> Self {
        match reason.kind() {
            ErrorKind::AlreadyExists | ErrorKind::IsADirectory => Self::exists(path),
            ErrorKind::NotFound => Self::at(path)(WriteFault::NoFolder),
            _ => Self::at(path)(WriteFault::NotCreated(reason)),
        }
    }
}
