//! One name means one thing in a crate.

use crate::arrows::ROOMS;
use crate::imports::{ModulePath, Sources};
use crate::source;
use crate::workspace;
use std::collections::BTreeMap;

/// Tests alone read this one, file by file.
const OF_TESTS: &str = "test-support/src";

/// The types outside of all braces, and whether each is public.
fn types(words: &[String]) -> Vec<(&str, bool)> {
    const KINDS: [&str; 5] = ["struct", "enum", "union", "trait", "type"];
    let mut depth = 0_i32;
    let mut found = Vec::new();
    for at in 0..words.len() {
        match words[at].as_str() {
            "{" | "(" | "[" => depth += 1,
            "}" | ")" | "]" => depth -= 1,
            kind if depth == 0 && KINDS.contains(&kind) && at + 1 < words.len() => {
                let is_public = at > 0 && words[at - 1] == "pub";
                found.push((words[at + 1].as_str(), is_public));
            }
            _ => {}
        }
    }
    found
}

/// What readers of a crate's documents find under one name is one type, and no file within it has another one of this name.
#[test]
fn a_public_type_has_its_name_alone_in_its_crate() {
    let mut shared = Vec::new();
    for (folder, _) in ROOMS.iter().filter(|(folder, _)| *folder != OF_TESTS) {
        let sources = Sources::read(&workspace().join(folder));
        let mut places: BTreeMap<&str, (bool, Vec<&ModulePath>)> = BTreeMap::new();
        for (module, words) in sources.words() {
            for (name, is_public) in types(words) {
                let (any_public, modules) = places.entry(name).or_default();
                *any_public |= is_public;
                modules.push(module);
            }
        }
        let ambiguous = places
            .iter()
            .filter(|(_, (public, at))| *public && at.len() > 1);
        shared.extend(ambiguous.map(|(name, (_, at))| {
            let at: Vec<String> = at.iter().map(|module| module.join("::")).collect();
            format!("{folder}: {name} in {}", at.join(", "))
        }));
    }
    assert!(
        shared.is_empty(),
        "one name, several types:\n{}",
        shared.join("\n")
    );
}

#[test]
fn types_within_braces_are_none_and_only_some_are_public() {
    let words = source::words(
        "pub struct A; pub(crate) enum B {} mod m { pub struct C; } impl X { type D = u8; } struct E;",
    );
    assert_eq!(types(&words), [("A", true), ("B", false), ("E", false)]);
}
