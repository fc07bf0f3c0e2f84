//! Code, comments and documents use the words of the glossary.

use crate::workspace;
use std::fs;
use std::path::{Path, PathBuf};

const GLOSSARY: &str = "docs/glossary.md";
/// Its last section: a table of words that are not used, and of those in their place.
pub const REPLACED: &str = "## Words that are not used";
/// These quote older words: the history, and files of earlier versions.
const QUOTING: [&str; 3] = ["CHANGELOG.md", "host/tests/data", "fuzz/corpus"];
const ENDINGS: [&str; 7] = ["c", "jl", "m", "md", "py", "rs", "toml"];

/// The first column of the table.
fn replaced(glossary: &str) -> Vec<String> {
    let (_, section) = glossary.split_once(REPLACED).expect("the section exists");
    let rows = section.lines().filter(|line| line.starts_with("| `"));
    rows.filter_map(|row| row.split('|').nth(1))
        .flat_map(|column| column.split('`').skip(1).step_by(2))
        .map(str::to_owned)
        .collect()
}

/// Whether a word is a name in code, not an English word.
fn is_name(word: &str) -> bool {
    word.contains('_') || word != word.to_lowercase()
}

/// Whether `line` has `word` as a whole word or as part of a longer `snake_case` name; an English word in capitals, too.
fn has_word(line: &str, word: &str) -> bool {
    let line = if is_name(word) {
        line.to_owned()
    } else {
        line.to_lowercase()
    };
    let is_letter = |c: Option<char>| c.is_some_and(char::is_alphanumeric);
    line.match_indices(word).any(|(at, _)| {
        let (before, after) = (&line[..at], &line[at + word.len()..]);
        !is_letter(before.chars().next_back()) && !is_letter(after.chars().next())
    })
}

/// All files of code and text below `folder`, by their paths in the workspace.
pub fn texts(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(workspace().join(folder)).expect("the folder can be read") {
        let entry = entry.expect("an entry can be read");
        let name = entry.file_name().into_string().expect("the name is UTF-8");
        let path = folder.join(&name);
        if name.starts_with('.') || name == "target" || QUOTING.iter().any(|q| path == Path::new(q))
        {
            continue;
        }
        if entry.file_type().expect("the type is known").is_dir() {
            texts(&path, found);
        } else if ENDINGS
            .iter()
            .any(|ending| path.extension() == Some(ending.as_ref()))
        {
            found.push(path);
        }
    }
}

#[test]
fn replaced_words_are_not_used() {
    let glossary = fs::read_to_string(workspace().join(GLOSSARY)).expect("the glossary is there");
    let words = replaced(&glossary);
    assert!(words.len() > 10, "{words:?}");
    let mut files = Vec::new();
    texts(Path::new(""), &mut files);
    assert!(files.len() > 300, "{}", files.len());
    let mut used = Vec::new();
    for file in files {
        let text = fs::read_to_string(workspace().join(&file)).expect("the file is text");
        // The table itself, and this test, have the words.
        let text = text.split(REPLACED).next().unwrap_or_default();
        for (number, line) in (1..).zip(text.lines()) {
            for word in words.iter().filter(|word| has_word(line, word)) {
                used.push(format!("{}:{number}: {word}", file.display()));
            }
        }
    }
    assert!(used.is_empty(), "see {GLOSSARY}:\n{}", used.join("\n"));
}

#[test]
fn words_are_found_in_names_but_not_in_other_words() {
    assert!(has_word("It Tells.", "tells"));
    assert!(has_word("let tells_from_hz = 1;", "tells"));
    assert!(!has_word("hotels, tellsome", "tells"));
    assert!(has_word("struct Wish;", "Wish") && !has_word("as you wish", "Wish"));
}
