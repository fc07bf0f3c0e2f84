//! The arrows between the rooms of each crate go one way, and no files of a crate import each other in a
//! circle.

use crate::imports::{Import, ModulePath, Sources};
use crate::workspace;
use std::collections::{BTreeMap, BTreeSet};

/// The folders and single files of each crate, the lowest first: each imports only what stands before it.
const ROOMS: [(&str, &[&str]); 6] = [
    ("protocol", &[]),
    ("firmware", &[]),
    ("simulator", &[]),
    (
        "identification",
        &[
            "error",
            "options",
            "numerics",
            "data",
            "estimation",
            "selection",
            "results",
            "diagnostics",
            "nonlinear",
            "flight_model",
            "identify",
            "comparison",
        ],
    ),
    (
        "host",
        &["data", "instrument", "presentation", "plan", "commands"],
    ),
    ("virtual-board", &[]),
];

fn name(path: &ModulePath) -> String {
    path.join("::")
}

fn of_crate(folder: &str) -> Sources {
    Sources::read(&workspace().join(folder).join("src"))
}

#[test]
fn rooms_import_only_rooms_below() {
    let mut wrong = Vec::new();
    for (folder, rooms) in ROOMS {
        let sources = of_crate(folder);
        for module in sources
            .modules()
            .filter(|module| !rooms.contains(&module[0].as_str()))
        {
            wrong.push(format!(
                "{folder}: {} is in no room of the table",
                name(module)
            ));
        }
        let floor = |path: &ModulePath| {
            rooms
                .iter()
                .position(|room| path.first().is_some_and(|p| p == room))
        };
        for Import { from, to, line } in sources.imports() {
            // The root re-exports all rooms.
            if from.is_empty() || floor(&to) <= floor(&from) && !to.is_empty() {
                continue;
            }
            wrong.push(format!(
                "{folder}: {} imports {} above it (line {line})",
                name(&from),
                name(&to)
            ));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn no_files_import_each_other_in_a_circle() {
    let mut wrong = Vec::new();
    for (folder, _) in ROOMS {
        for circle in circles(&of_crate(folder).imports()) {
            let names: Vec<String> = circle.iter().map(name).collect();
            wrong.push(format!("{folder}: {}", names.join(", ")));
        }
    }
    assert!(wrong.is_empty(), "circles:\n{}", wrong.join("\n"));
}

/// The groups of files of which each can be reached from each other.
fn circles(imports: &[Import]) -> Vec<Vec<ModulePath>> {
    let mut to: BTreeMap<&ModulePath, Vec<&ModulePath>> = BTreeMap::new();
    for import in imports {
        to.entry(&import.from).or_default().push(&import.to);
    }
    let reach = |from: &ModulePath| {
        let mut seen = BTreeSet::new();
        let mut open: Vec<&ModulePath> = to.get(from).into_iter().flatten().copied().collect();
        while let Some(next) = open.pop() {
            if seen.insert(next) {
                open.extend(to.get(next).into_iter().flatten());
            }
        }
        seen
    };
    let reached: BTreeMap<&ModulePath, BTreeSet<&ModulePath>> =
        to.keys().map(|from| (*from, reach(from))).collect();
    let mut found: BTreeSet<Vec<ModulePath>> = BTreeSet::new();
    for (from, there) in &reached {
        let back = |other: &&ModulePath| reached.get(other).is_some_and(|seen| seen.contains(from));
        let circle: Vec<ModulePath> = there.iter().copied().filter(back).cloned().collect();
        if circle.contains(from) {
            found.insert(circle);
        }
    }
    found.into_iter().collect()
}

#[test]
fn circles_are_found() {
    let import = |from: &str, to: &str| Import {
        from: vec![from.to_owned()],
        to: vec![to.to_owned()],
        line: 1,
    };
    let imports = [
        import("a", "b"),
        import("b", "c"),
        import("c", "b"),
        import("c", "d"),
    ];
    assert_eq!(
        circles(&imports),
        [[vec!["b".to_owned()], vec!["c".to_owned()]]]
    );
}
