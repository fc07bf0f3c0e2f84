//! An error in a file of any kind.

use std::fmt::{Debug, Display};
use std::path::{Path, PathBuf};

/// An error in a file: its text is the name of the file and the `fault`, which names the remedy.
#[derive(Debug, thiserror::Error)]
#[error("{path:?} {fault}")]
pub struct FileError<F: Debug + Display> {
    /// Which file.
    pub path: PathBuf,
    /// The fault in it.
    pub fault: F,
}

impl<F: Debug + Display> FileError<F> {
    /// Names the file of a fault.
    pub(crate) fn at(path: &Path) -> impl Fn(F) -> Self {
        move |fault| Self {
            path: path.to_owned(),
            fault,
        }
    }
}
