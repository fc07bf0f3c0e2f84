//! Why a recording could not be written.

use std::io::{Error, ErrorKind};
use std::path::{Path, PathBuf};

/// Why a recording could not be written. The text names the remedy.
#[derive(Debug, thiserror::Error)]
pub enum WriteError {
    /// The target is there already.
    #[error("{path:?} exists already: choose another name, or add --force to replace it")]
    Exists {
        /// Which.
        path: PathBuf,
    },
    /// The target is a folder.
    #[error("{path:?} is a folder: give the name of a file in it")]
    Folder {
        /// Which.
        path: PathBuf,
    },
    /// Its folder is not there.
    #[error("{path:?} cannot be written: its folder is not there; make it first")]
    NoFolder {
        /// Which.
        path: PathBuf,
    },
    /// The file cannot be made.
    #[error("{path:?} cannot be written: {reason}")]
    NotCreated {
        /// Which.
        path: PathBuf,
        /// What the system said.
        reason: Error,
    },
    /// Another program writes to it.
    #[error(
        "{path:?} is being written by another program: wait for its end, or choose another name"
    )]
    InUse {
        /// Which.
        path: PathBuf,
    },
    /// The file had no name any more, and has got another one.
    #[error(
        "{path:?} was removed or replaced by another program while it was written: all of its {rows} rows are in {kept:?}"
    )]
    Rescued {
        /// Where it was to be.
        path: PathBuf,
        /// Where it is.
        kept: PathBuf,
        /// Rows that are in it.
        rows: u64,
    },
    /// The file has no name any more.
    #[error(
        "{path:?} was removed or replaced by another program while it was written: its {rows} rows are lost"
    )]
    Removed {
        /// Which.
        path: PathBuf,
        /// Rows that were in it.
        rows: u64,
    },
    /// The disk is full or gone.
    #[error("{path:?} could not be written on ({reason}): the {rows} rows so far are kept")]
    Stopped {
        /// Which.
        path: PathBuf,
        /// Rows that are on the disk.
        rows: u64,
        /// What the system said.
        reason: Error,
    },
}

impl WriteError {
    /// That `path` is there already.
    pub(crate) fn exists(path: &Path) -> Self {
        let path = path.to_owned();
        if path.is_dir() {
            Self::Folder { path }
        } else {
            Self::Exists { path }
        }
    }

    /// That `path` cannot be made, and why.
    pub(crate) fn not_created(path: &Path, reason: Error) -> Self {
        match reason.kind() {
            ErrorKind::AlreadyExists | ErrorKind::IsADirectory => Self::exists(path),
            ErrorKind::NotFound => Self::NoFolder {
                path: path.to_owned(),
            },
            _ => Self::NotCreated {
                path: path.to_owned(),
                reason,
            },
        }
    }
}
