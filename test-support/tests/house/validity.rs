//! Bounds become valid in one place.

use crate::workspace;
use std::path::{Path, PathBuf};

/// The place that decides, and the type itself, which hands on what is valid and reads documents.
const ALLOWED: [&str; 2] = [
    "identification/src/diagnostics/validity.rs",
    "identification/src/results/validity.rs",
];

fn sources(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).expect("the folder is there") {
        let path = entry.expect("the folder can be read").path();
        if path.file_stem().is_some_and(|name| name == "tests") {
            continue;
        }
        if path.is_dir() {
            sources(&path, found);
        } else if path.extension().is_some_and(|end| end == "rs") && !path.ends_with("tests.rs") {
            found.push(path);
        }
    }
}

/// Whether `rest`, from behind the name of the variant, makes a value. Patterns are followed by `=>`, `=` or a guard.
fn makes_a_value(rest: &str) -> bool {
    let mut depth = 0;
    let end = rest.find(|c| {
        depth += match c {
            '(' => 1,
            ')' => -1,
            _ => 0,
        };
        depth == 0
    });
    let Some(end) = end.filter(|_| rest.starts_with('(')) else {
        return true;
    };
    let behind = rest[end + 1..].trim_start();
    !["=", "if ", "|", ") =", ")) ="]
        .iter()
        .any(|pattern| behind.starts_with(pattern))
}

#[test]
fn nothing_but_the_evidence_makes_bounds_valid() {
    let mut files = Vec::new();
    for folder in ["identification/src", "host/src", "client/src"] {
        sources(&workspace().join(folder), &mut files);
    }
    let mut forged = Vec::new();
    for file in files {
        let name = file
            .strip_prefix(workspace())
            .expect("it is of the workspace")
            .display()
            .to_string();
        let text = std::fs::read_to_string(&file).expect("it can be read");
        let code = text
            .split("#[cfg(test)]\nmod tests {")
            .next()
            .unwrap_or_default();
        for (at, variant) in code.match_indices("Bounds::Valid") {
            if !ALLOWED.contains(&name.as_str()) && makes_a_value(&code[at + variant.len()..]) {
                forged.push(format!("{name}:{}", 1 + code[..at].matches('\n').count()));
            }
        }
    }
    assert!(forged.is_empty(), "bounds are made valid in {forged:?}");
}

#[test]
fn patterns_are_no_values() {
    assert!(makes_a_value("(level)"));
    assert!(makes_a_value("(of(level)),"));
    assert!(makes_a_value(");"));
    assert!(!makes_a_value("(bounds) => bounds"));
    assert!(!makes_a_value("((a, b)) = both {"));
    assert!(!makes_a_value("(bounds)) => bounds"));
    assert!(!makes_a_value("(_) if linear"));
}
