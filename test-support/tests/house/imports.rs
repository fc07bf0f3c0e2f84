//! Which file of a crate imports which other: by the definition that a path leads to.
//!
//! A path that ends at a re-export counts for the file that defines the item. The scanner knows no macros
//! and no modules inside a file; a path that it cannot resolve counts for the last file on its way.

use crate::source::words;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

/// `["data", "timing"]` for `data/timing.rs`; empty for `lib.rs`.
pub type ModulePath = Vec<String>;

/// One file's import of another.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct Import {
    pub from: ModulePath,
    pub to: ModulePath,
}

/// The files of a crate and the names in them.
#[derive(Debug, Default)]
pub struct Sources(BTreeMap<ModulePath, File>);

#[derive(Debug, Default)]
struct File {
    words: Vec<String>,
    /// Items at the top level.
    defined: BTreeSet<String>,
    uses: Uses,
}

/// Names of its own crate in a file.
#[derive(Debug, Default)]
struct Uses {
    /// Names from `use`, with their paths.
    names: BTreeMap<String, ModulePath>,
    /// Modules of `use ..::*`.
    globs: Vec<ModulePath>,
    /// All paths.
    paths: Vec<ModulePath>,
}

impl Uses {
    fn add(&mut self, path: ModulePath, name: String) {
        if name == "*" {
            self.globs.push(path[..path.len() - 1].to_vec());
        } else {
            self.names.insert(name, path.clone());
        }
        self.paths.push(path);
    }
}

/// The end of a path.
enum Named {
    Module,
    ItemOf(ModulePath),
}

impl Sources {
    /// Reads all files below `folder` but tests and programs.
    pub fn read(folder: &Path) -> Self {
        let mut files = BTreeMap::new();
        collect(folder, &mut Vec::new(), &mut files);
        Self::of(files)
    }

    /// The words of each file.
    pub fn words(&self) -> impl Iterator<Item = (&ModulePath, &[String])> {
        self.0
            .iter()
            .map(|(path, file)| (path, file.words.as_slice()))
    }

    fn of(texts: BTreeMap<ModulePath, String>) -> Self {
        let mut sources = Self::default();
        for (path, text) in texts {
            let words = words(&text);
            let defined = defined(&words);
            let uses = Uses::default();
            sources.0.insert(
                path,
                File {
                    words,
                    defined,
                    uses,
                },
            );
        }
        let places: Vec<ModulePath> = sources.0.keys().cloned().collect();
        for place in places {
            let uses = sources.uses(&place);
            if let Some(file) = sources.0.get_mut(&place) {
                file.uses = uses;
            }
        }
        sources
    }

    /// All files but the root.
    pub fn modules(&self) -> impl Iterator<Item = &ModulePath> {
        self.0.keys().filter(|path| !path.is_empty())
    }

    /// Every import between two files, once.
    pub fn imports(&self) -> BTreeSet<Import> {
        let mut found = BTreeSet::new();
        for (from, file) in &self.0 {
            for path in &file.uses.paths {
                if let Some(Named::ItemOf(to)) = self.resolve(path, 0)
                    && to != *from
                {
                    let from = from.clone();
                    found.insert(Import { from, to });
                }
            }
        }
        found
    }

    /// The end of a path from the root; `None` if it leads in a circle of re-exports.
    fn resolve(&self, path: &[String], depth: usize) -> Option<Named> {
        if depth > 8 {
            return None;
        }
        let on_the_way = (0..=path.len()).rev();
        let length = on_the_way
            .into_iter()
            .find(|&k| self.0.contains_key(&path[..k]))?;
        let (module, rest) = path.split_at(length);
        let Some((item, further)) = rest.split_first() else {
            return Some(Named::Module);
        };
        let file = &self.0[module];
        if file.defined.contains(item) || item == "*" {
            return Some(Named::ItemOf(module.to_vec()));
        }
        let continued = |start: &ModulePath| [start.as_slice(), further].concat();
        if let Some(meant) = file.uses.names.get(item) {
            return self.resolve(&continued(meant), depth + 1);
        }
        for glob in &file.uses.globs {
            let all = self.resolve(&[glob.as_slice(), rest].concat(), depth + 1);
            if let Some(Named::ItemOf(place)) = all
                && self.0[&place].defined.contains(item)
            {
                return Some(Named::ItemOf(place));
            }
        }
        Some(Named::ItemOf(module.to_vec()))
    }

    fn uses(&self, place: &ModulePath) -> Uses {
        let words = &self.0[place].words;
        let mut uses = Uses::default();
        let mut inline = Vec::new();
        let mut at = 0;
        while at < words.len() {
            if words[at] == "use" {
                let length = words[at..].iter().position(|word| word == ";");
                let end = length.map_or(words.len(), |length| at + length);
                for (path, name) in use_tree(&words[at + 1..end], &[]) {
                    if let Some(path) = self.absolute(place, &path) {
                        uses.add(path, name);
                    }
                }
                at = end;
            } else if begins_a_path(words, at) {
                let path = inline_path(words, at);
                at += 2 * path.len() - 1;
                inline.push(path);
            } else {
                at += 1;
            }
        }
        for path in inline {
            let known = uses.names.get(&path[0]);
            let known = known.map(|start| [start, &path[1..]].concat());
            uses.paths
                .extend(known.or_else(|| self.absolute(place, &path)));
        }
        uses
    }

    /// From the root of the crate; `None` for other crates.
    fn absolute(&self, place: &ModulePath, path: &[String]) -> Option<ModulePath> {
        let (first, rest) = path.split_first()?;
        match first.as_str() {
            "crate" => Some(rest.to_vec()),
            "self" => Some([place.as_slice(), rest].concat()),
            "super" => {
                let (_, mut parent) = place.split_last()?;
                let mut rest = rest;
                while let Some(("super", further)) =
                    rest.split_first().map(|(f, r)| (f.as_str(), r))
                {
                    (parent, rest) = (parent.split_last()?.1, further);
                }
                Some([parent, rest].concat())
            }
            _ => {
                let below = [place.as_slice(), std::slice::from_ref(first)].concat();
                let is_child = self.0.contains_key(&below);
                is_child.then(|| [place.as_slice(), path].concat())
            }
        }
    }
}

fn collect(folder: &Path, place: &mut ModulePath, files: &mut BTreeMap<ModulePath, String>) {
    let entries = fs::read_dir(folder).expect("the folder can be read");
    for entry in entries {
        let path = entry.expect("an entry can be read").path();
        let stem = path.file_stem().and_then(|stem| stem.to_str());
        let stem = stem.expect("the name is UTF-8").to_owned();
        if path.is_dir() {
            if !matches!(stem.as_str(), "tests" | "bin") {
                place.push(stem);
                collect(&path, place, files);
                place.pop();
            }
        } else if path.extension().is_some_and(|ending| ending == "rs") {
            let module = match stem.as_str() {
                "tests" => continue,
                "main" if place.is_empty() => continue,
                "lib" if place.is_empty() => Vec::new(),
                "mod" => place.clone(),
                _ => [place.as_slice(), &[stem]].concat(),
            };
            let text = fs::read_to_string(&path).expect("the file can be read");
            files.insert(module, text);
        }
    }
}

/// Names of items that are defined outside of all braces.
fn defined(words: &[String]) -> BTreeSet<String> {
    const KINDS: [&str; 8] = [
        "struct", "enum", "union", "trait", "fn", "const", "static", "type",
    ];
    let mut depth = 0_i32;
    let mut names = BTreeSet::new();
    for pair in words.windows(2) {
        match pair[0].as_str() {
            "{" | "(" | "[" => depth += 1,
            "}" | ")" | "]" => depth -= 1,
            kind if depth == 0 && KINDS.contains(&kind) => drop(names.insert(pair[1].clone())),
            _ => {}
        }
    }
    names
}

fn is_name(word: &str) -> bool {
    word.starts_with(|c: char| c.is_alphabetic() || c == '_')
}

fn begins_a_path(words: &[String], at: usize) -> bool {
    let text = |k: usize| words.get(k).map(String::as_str);
    is_name(&words[at]) && text(at + 1) == Some("::") && (at == 0 || text(at - 1) != Some("::"))
}

fn inline_path(words: &[String], at: usize) -> ModulePath {
    let mut path = vec![words[at].clone()];
    let mut pairs = words[at + 1..].chunks_exact(2);
    while let Some([mark, name]) = pairs.next()
        && mark == "::"
        && is_name(name)
    {
        path.push(name.clone());
    }
    path
}

/// Paths, and the names that they get.
fn use_tree(words: &[String], prefix: &[String]) -> Vec<(ModulePath, String)> {
    let mut found = Vec::new();
    for branch in branches(words) {
        let mut path = prefix.to_vec();
        let mut rest = branch;
        while let [word, tail @ ..] = rest {
            match word.as_str() {
                "::" => {}
                "{" => {
                    found.extend(use_tree(&tail[..tail.len() - 1], &path));
                    path.clear();
                    break;
                }
                "as" => {
                    let name = tail.first().map_or_else(String::new, String::clone);
                    found.push((std::mem::take(&mut path), name));
                    break;
                }
                "self" if !path.is_empty() => {}
                _ => path.push(word.clone()),
            }
            rest = tail;
        }
        if let Some(name) = path.last().cloned() {
            found.push((path, name));
        }
    }
    found
}

/// The parts between the commas that are in no braces.
fn branches(words: &[String]) -> Vec<&[String]> {
    let mut depth = 0;
    words
        .split(|word| {
            match word.as_str() {
                "{" => depth += 1,
                "}" => depth -= 1,
                _ => {}
            }
            depth == 0 && word == ","
        })
        .filter(|branch| !branch.is_empty())
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn imports(files: &[(&str, &str)]) -> Vec<String> {
        let texts = files.iter().map(|(path, text)| {
            let path = path.split("::").filter(|part| !part.is_empty());
            (path.map(str::to_owned).collect(), (*text).to_owned())
        });
        let found = Sources::of(texts.collect()).imports();
        let written = found
            .iter()
            .map(|i| format!("{} -> {}", i.from.join("::"), i.to.join("::")));
        written.collect()
    }

    #[test]
    fn paths_lead_to_the_file_that_defines() {
        let found = imports(&[
            (
                "",
                "mod a; mod b; pub use a::deep::Thing; pub use b as other;",
            ),
            (
                "a",
                "mod deep; pub use deep::{Thing, helper as help}; const LIMIT: f64 = 1.0;",
            ),
            (
                "a::deep",
                "use super::LIMIT; pub struct Thing; pub fn helper() {}",
            ),
            (
                "b",
                "use crate::a::{self, help}; fn f() -> crate::Thing { a::LIMIT }",
            ),
            (
                "c",
                "use crate::other::f; use std::fmt; fn g() { super::b::f() }",
            ),
        ]);
        let expected = [
            " -> a::deep",
            "a -> a::deep",
            "a::deep -> a",
            "b -> a",
            "b -> a::deep",
            "c -> b",
        ];
        assert_eq!(found, expected);
    }

    #[test]
    fn globs_and_trees_are_followed() {
        let found = imports(&[
            ("", "mod a; mod b; mod c;"),
            ("a", "pub use crate::b::*; pub use crate::c;"),
            ("b", "pub enum Kind { One }"),
            (
                "c",
                "use crate::{a::{Kind, c::Q as R}, b::Kind::One}; pub struct Q;",
            ),
        ]);
        assert_eq!(found, ["a -> b", "c -> b"]);
    }
}
