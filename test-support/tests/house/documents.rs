//! The glossary and the method name files and modules that exist.

use crate::words::REPLACED;
use crate::workspace;
use std::path::PathBuf;

fn document(name: &str) -> String {
    std::fs::read_to_string(workspace().join("docs").join(name)).unwrap()
}

#[test]
fn every_path_in_the_glossary_exists() {
    let text = document("glossary.md");
    // The last table has words instead of paths.
    let (terms, _) = text.split_once(REPLACED).unwrap();
    let paths: Vec<&str> = terms
        .lines()
        .flat_map(|line| line.split('`').skip(1).step_by(2))
        .collect();
    assert!(paths.len() > 50);
    let missing: Vec<_> = paths
        .iter()
        .filter(|path| !workspace().join(path).exists())
        .collect();
    assert!(missing.is_empty(), "{missing:#?}");
}

#[test]
fn every_module_that_the_method_names_exists() {
    let text = document("method.md");
    let sources = workspace().join("identification/src");
    let rooms: Vec<PathBuf> = std::fs::read_dir(&sources)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .chain([sources])
        .collect();
    let exists = |module: &String| {
        rooms
            .iter()
            .any(|room| room.join(module).is_dir() || room.join(format!("{module}.rs")).is_file())
    };
    let missing: Vec<String> = text
        .split("[`")
        .skip(1)
        .filter_map(|rest| Some(rest.split_once("`]")?.0.replace("::", "/")))
        .filter(|module| !exists(module))
        .collect();
    assert!(missing.is_empty(), "{missing:#?}");
}
