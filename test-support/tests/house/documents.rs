//! The documents name files, modules and tests that exist.

use crate::words::{REPLACED, texts};
use crate::workspace;
use std::path::{Path, PathBuf};

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

/// `folder` and all folders in it, at any depth.
fn folders_below(folder: &Path) -> Vec<PathBuf> {
    let inner = std::fs::read_dir(folder).unwrap();
    let inner = inner.map(|entry| entry.unwrap().path());
    let mut all: Vec<PathBuf> = inner
        .filter(|path| path.is_dir())
        .flat_map(|path| folders_below(&path))
        .collect();
    all.push(folder.to_owned());
    all
}

#[test]
fn every_module_that_the_method_names_exists() {
    let text = ["method.md", "coverage.md", "assumptions.md"]
        .map(document)
        .concat();
    let rooms = folders_below(&workspace().join("identification/src"));
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

/// The words in backticks of a document, without its blocks of code.
fn quoted(text: &str) -> impl Iterator<Item = &str> {
    text.split('`').skip(1).step_by(2)
}

#[test]
fn every_file_that_the_guides_name_exists() {
    const ENDINGS: [&str; 5] = ["rs", "md", "py", "toml", "txt"];
    for guide in ["ARCHITECTURE.md", "CONTRIBUTING.md"] {
        let text = std::fs::read_to_string(workspace().join(guide)).unwrap();
        let is_path = |word: &&str| {
            let ending = word.rsplit_once('.').map_or("", |(_, ending)| ending);
            !word.contains(' ') && (word.contains('/') || ENDINGS.contains(&ending))
        };
        let paths: Vec<&str> = quoted(&text).filter(is_path).collect();
        assert!(paths.len() > 20, "{guide} names {}", paths.len());
        let missing: Vec<_> = paths
            .iter()
            .filter(|path| !workspace().join(path).exists())
            .collect();
        assert!(missing.is_empty(), "{guide}: {missing:#?}");
    }
}

#[test]
fn every_test_and_file_that_a_promise_names_exists() {
    let text = document("reliability.md");
    let mut files = Vec::new();
    texts(Path::new(""), &mut files);
    let rust = files
        .iter()
        .filter(|file| file.extension() == Some("rs".as_ref()));
    let sources: Vec<String> = rust
        .map(|file| std::fs::read_to_string(workspace().join(file)).unwrap())
        .collect();
    let mut missing = Vec::new();
    let mut tests = 0;
    for word in quoted(&text) {
        let is_path = word.contains('/') && word.ends_with(".rs");
        if is_path && !workspace().join(word).exists() {
            missing.push(word);
        }
        let name = word.trim_end_matches("...");
        let is_name = name
            .chars()
            .all(|letter| letter.is_ascii_lowercase() || letter.is_ascii_digit() || letter == '_');
        if !is_name || name.matches('_').count() < 2 {
            continue;
        }
        tests += 1;
        let whole = if name == word { "(" } else { "" };
        let definition = format!("fn {name}{whole}");
        if !sources.iter().any(|source| source.contains(&definition)) {
            missing.push(word);
        }
    }
    assert!(tests > 50, "{tests}");
    assert!(missing.is_empty(), "{missing:#?}");
}
