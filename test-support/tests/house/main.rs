//! The rules of the house: which crate may depend on which, which room on which, and what else a change
//! must not break without anybody noticing.

mod arrows;
mod documents;
mod imports;
mod manifests;
mod source;
mod validity;

use std::path::{Path, PathBuf};

/// The folder of the workspace.
fn workspace() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}
