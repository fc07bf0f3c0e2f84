//! The rules of the workspace: which crate and which room may import which, and which documents must match
//! the code.

mod arrows;
mod checks;
mod documents;
mod imports;
mod manifests;
mod names;
mod source;
mod validity;
mod words;

use std::path::{Path, PathBuf};

/// The folder of the workspace.
fn workspace() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}
