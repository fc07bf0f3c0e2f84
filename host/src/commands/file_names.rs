//! Names of files as commands use them.

use std::path::Path;

/// A file's name without folder and ending, for plots and for the terminal.
pub(super) fn stem(path: &Path) -> String {
    path.file_stem()
        .unwrap_or(path.as_os_str())
        .to_string_lossy()
        .into_owned()
}

/// Whether a file is a model, by its ending; any other file is read as a recording.
pub(super) fn is_model(path: &Path) -> bool {
    path.extension().is_some_and(|ending| ending == "json")
}
