//! Files that commands write: never over an existing one without `--force`.

use crate::data::recording::{WholeFile, WriteError};
use crate::presentation::plots::{Figure, draw};
use anyhow::{Context, Result};
use std::io::Write;
use std::path::{Path, PathBuf};

/// Says a line on standard error, if there is anybody who listens: a pipe that was closed or a
/// terminal that is gone must not end a run on a servo.
pub fn tell(line: impl std::fmt::Display) {
    let _nobody_listens = writeln!(std::io::stderr(), "{line}");
}

/// Makes a file that was not there, or whose loss is allowed, with this content: all of it, or the
/// file that was there stays.
///
/// # Errors
/// One sentence: it exists, or what the system said.
pub fn write_file(path: &Path, force: bool, content: &str) -> Result<()> {
    let whole = WholeFile::new(path, force)?;
    let written = whole.file()?.write_all(content.as_bytes());
    written.map_err(|reason| WriteError::NotCreated {
        path: path.to_owned(),
        reason,
    })?;
    Ok(whole.put_in_place()?)
}

/// Fails now if `path` could not be written later: before an hour of work rather than after it.
///
/// # Errors
/// [`WriteError::Exists`].
pub fn check_free(path: &Path, force: bool) -> Result<()> {
    if !force && path.exists() {
        return Err(WriteError::exists(path).into());
    }
    Ok(())
}

/// Draws figures into a folder, which is made if it is not there; returns the files.
///
/// # Errors
/// One sentence.
pub fn write_figures(folder: &Path, force: bool, figures: &[Figure]) -> Result<Vec<PathBuf>> {
    std::fs::create_dir_all(folder)
        .with_context(|| format!("the folder {folder:?} cannot be made"))?;
    let mut files = Vec::new();
    for figure in figures {
        let path = folder.join(format!("{}.svg", figure.name));
        let drawing = draw(figure)
            .map_err(|e| anyhow::anyhow!("the plot {:?} cannot be drawn: {e}", figure.name))?;
        write_file(&path, force, &drawing)?;
        files.push(path);
    }
    Ok(files)
}

/// A result as indented JSON with a final line end.
///
/// # Errors
/// When a value has no form in JSON.
pub fn to_json(value: &impl serde::Serialize) -> Result<String> {
    Ok(serde_json::to_string_pretty(value).context("the result cannot be written as JSON")? + "\n")
}
