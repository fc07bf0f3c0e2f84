//! The rig file as it was: neither a wrong calibration nor a new beginning may be the end of a right one.

use crate::data::numbered_path::with_suffix;
use crate::data::recording::write_file;
use anyhow::{Context, Result};
use std::path::{Path, PathBuf};

/// Copies a file that is about to be replaced to a free name beside it, such as rig-1.toml, and returns that; `None` where
/// there is no such file.
pub(in crate::commands) fn keep_aside(path: &Path) -> Result<Option<PathBuf>> {
    if !path.is_file() {
        return Ok(None);
    }
    let content = std::fs::read_to_string(path);
    let content = content.with_context(|| format!("the rig file {path:?} cannot be read"))?;
    let Some(copy) = (1..)
        .map(|number: u32| with_suffix(path, &format!("-{number}")))
        .find(|copy| !copy.exists())
    else {
        return Ok(None);
    };
    write_file(&copy, false, &content)?;
    Ok(Some(copy))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_file_that_was_is_kept() {
        let dir = tempfile::tempdir().unwrap();
        let rig = dir.path().join("my.rig.toml");
        assert_eq!(keep_aside(&rig).unwrap(), None);
        for number in 1..3 {
            std::fs::write(&rig, format!("name = \"{number}\"")).unwrap();
            let kept = keep_aside(&rig).unwrap().unwrap();
            assert_eq!(kept, dir.path().join(format!("my.rig-{number}.toml")));
            assert_eq!(std::fs::read(&kept).unwrap(), std::fs::read(&rig).unwrap());
        }
    }
}
