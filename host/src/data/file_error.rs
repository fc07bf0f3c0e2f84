//! What is wrong with a file, whatever kind of file it is.

use std::fmt::{Debug, Display};
use std::path::{Path, PathBuf};

/// What is wrong with a file: the text is its name and the `fault`, which names the remedy.
#[derive(Debug, thiserror::Error)]
#[error("{path:?} {fault}")]
pub struct FileError<F: Debug + Display> {
    /// Which file.
    pub path: PathBuf,
    /// What is wrong with it.
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
