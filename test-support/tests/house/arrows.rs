//! The arrows between the rooms of each crate go one way, and no files of a crate import each other in a
//! circle.

use crate::imports::{Import, ModulePath, Sources};
use crate::workspace;
use std::collections::{BTreeMap, BTreeSet};

/// The folders and single files of each crate, or program, the lowest first: each imports only those before it.
pub const ROOMS: [(&str, &[&str]); 11] = [
    (
        "protocol/src",
        &[
            "units",
            "pulse_train",
            "timing",
            "lease",
            "framing",
            "reference",
            "hello",
            "health",
            "loopback",
            "message",
            "schema",
        ],
    ),
    (
        "client/src",
        &[
            "commanded",
            "error",
            "mismatch",
            "silence",
            "frame_order",
            "gaps",
            "run_ending",
            "request",
            "event",
            "line",
            "task",
            "session",
            "run",
            "foreign_traffic",
            "client",
        ],
    ),
    (
        "firmware/src",
        &[
            "board",
            "limits",
            "loopback",
            "frame_history",
            "outbox",
            "run",
            "session",
            "supply_meter",
            "rig",
            "serve",
        ],
    ),
    (
        "dynamics/src",
        &[
            "commands",
            "dual",
            "equation",
            "stepper",
            "start",
            "rest",
            "sloped_stepper",
            "simulation",
        ],
    ),
    (
        "simulator/src",
        &[
            "servo",
            "random",
            "delay_line",
            "load",
            "motor",
            "run_to_run",
            "bench",
            "aircraft",
            "linear",
            "identified_servo",
            "sensor",
            "noise",
            "options",
            "parts",
            "apparatus",
            "board",
            "serial_line",
            "in_process",
            "simulate",
        ],
    ),
    (
        "identification/src",
        &[
            "error",
            "thresholds",
            "options",
            "numerics",
            "data",
            "estimation",
            "selection",
            "results",
            "diagnostics",
            "nonlinear",
            "flight_model",
            "servo_model",
            "identify",
            "comparison",
        ],
    ),
    (
        "host/src",
        &[
            "data",
            "instrument",
            "presentation",
            "plan",
            "analysis",
            "commands",
        ],
    ),
    (
        "virtual-board/src",
        &[
            "time",
            "record",
            "fault",
            "memory",
            "flash_memory",
            "loop_wire",
            "supply",
            "options",
            "plant",
            "rtt",
            "image",
            "cpu",
            "peripherals",
            "line",
            "bootloader",
            "chip",
            "bus",
            "board",
            "server",
        ],
    ),
    (
        "python/src",
        &[
            "arguments",
            "arrays",
            "error",
            "export",
            "compute",
            "model",
            "data",
            "identification",
            "sides",
            "rig",
            "program",
        ],
    ),
    (
        "test-support/src",
        &[
            "arguments",
            "tools",
            "plants",
            "servos",
            "limited_drive",
            "trial",
            "loggers",
            "drifting_servos",
            "closed_loop",
            "oracle",
            "coverage",
            "hard_lines",
            "compared_ends",
            "drawn_lines",
            "scattering_holds",
            "scattering_runs",
            "noisy_commands",
            "low_order_coverage",
            "smooth_inputs",
            "figures_coverage",
            "metrics_coverage",
            "changing_servos",
            "servo_means",
            "shifted_pairs",
            "hello",
            "bad_line",
            "trials",
            "stepped",
            "virtual_board",
        ],
    ),
    (
        "firmware/src/bin/servoid-firmware",
        &[
            "line",
            "small_part",
            "last_fault",
            "safety",
            "stack",
            "clock",
            "watchdog",
            "debugger",
            "serial",
            "timing",
            "awake",
            "pulse",
            "supply",
            "injected",
            "sampling",
            "identity",
        ],
    ),
];

/// The rooms of the folders that are houses of their own: crate, folder, and its rooms as in [`ROOMS`].
const INNER_ROOMS: [(&str, &str, &[&str]); 4] = [
    (
        "identification/src",
        "diagnostics",
        &[
            "residuals",
            "causality",
            "runs",
            "holds",
            "commands",
            "response_end",
            "noise",
            "linearity",
            "misfit",
            "outlying",
            "travel",
            "times",
            "prior_outcome",
            "validity",
            "explanation",
            "advice",
        ],
    ),
    (
        "identification/src",
        "servo_model",
        &[
            "search_progress",
            "stretches",
            "motion",
            "descent",
            "terms",
            "uncertainty",
            "search_setup",
            "candidates",
            "runs_alone",
            "quantities",
            "model",
            "estimate",
            "beside_linear",
            "coverage",
        ],
    ),
    (
        "host/src",
        "analysis",
        &[
            "duration_in_words",
            "json",
            "recording_advice",
            "command_times",
            "one_servo",
            "two_servos",
            "against_recordings",
            "exported",
            "simulation",
        ],
    ),
    (
        "host/src",
        "presentation::summary",
        &[
            "wording",
            "response",
            "servo",
            "both_models",
            "two_servos",
            "validation",
            "headline",
            "key_figures",
        ],
    ),
];

/// Imports that still point upward, as the test writes them. A line that is no longer needed fails the test.
const STILL_UPWARD: &[&str] = &[];

/// Files that still import each other in circles, as the test writes them.
const STILL_CIRCLES: &[&str] = &[];

fn name(path: &ModulePath) -> String {
    path.join("::")
}

fn of_crate(folder: &str) -> Sources {
    Sources::read(&workspace().join(folder))
}

/// The imports that point upward between `rooms`, of files below `folder`, a path within the crate, and lines on rooms that either lacks.
fn upward(sources: &Sources, folder: &[&str], rooms: &[&str]) -> Vec<String> {
    let room = |path: &ModulePath| path.get(folder.len()).cloned();
    let is_within = |path: &ModulePath| {
        path.len() >= folder.len() && path.iter().zip(folder).all(|(a, b)| a == b)
    };
    let floor = |path: &ModulePath| {
        rooms
            .iter()
            .position(|found| Some(*found) == room(path).as_deref())
    };
    let modules: Vec<&ModulePath> = sources.modules().filter(|path| is_within(path)).collect();
    let is_empty = |found: &&&str| {
        !modules
            .iter()
            .any(|path| room(path).as_deref() == Some(**found))
    };
    let gone = rooms.iter().filter(is_empty);
    let gone = gone.map(|found| format!("the table has {found}, which is not there"));
    let is_new = |path: &&&ModulePath| room(path).is_some() && floor(path).is_none();
    let new = modules.iter().filter(is_new);
    let new = new.map(|path| format!("the table has no room for {}", name(path)));
    // The root re-exports all rooms: it may import, and is not imported.
    let points_up = |import: &&Import| {
        let Import { from, to } = import;
        is_within(from)
            && is_within(to)
            && room(from).is_some()
            && floor(to).is_none_or(|to| Some(to) > floor(from))
    };
    let imports = sources.imports();
    let up = imports.iter().filter(points_up);
    let up = up.map(|Import { from, to }| match to.is_empty() {
        true => format!("{} imports lib", name(from)),
        false => format!("{} imports {}", name(from), name(to)),
    });
    gone.chain(new).chain(up).collect()
}

#[test]
fn rooms_import_only_rooms_below() {
    let mut found = Vec::new();
    for (folder, rooms) in ROOMS {
        let lines = upward(&of_crate(folder), &[], rooms);
        found.extend(lines.iter().map(|line| format!("{folder}: {line}")));
    }
    for (folder, inner, rooms) in INNER_ROOMS {
        let inner: Vec<&str> = inner.split("::").collect();
        let lines = upward(&of_crate(folder), &inner, rooms);
        found.extend(lines.iter().map(|line| format!("{folder}: {line}")));
    }
    require("imports that point upward", &found, STILL_UPWARD);
}

#[test]
fn no_files_import_each_other_in_a_circle() {
    let mut found = Vec::new();
    for (folder, _) in ROOMS {
        for circle in circles(&of_crate(folder).imports()) {
            let names: Vec<String> = circle.iter().map(name).collect();
            found.push(format!("{folder}: {}", names.join(", ")));
        }
    }
    require("circles", &found, STILL_CIRCLES);
}

/// The found lines are the known ones, no more and no less.
fn require(what: &str, found: &[String], known: &[&str]) {
    let new: Vec<&str> = found
        .iter()
        .map(String::as_str)
        .filter(|line| !known.contains(line))
        .collect();
    let gone: Vec<&str> = known
        .iter()
        .copied()
        .filter(|line| !found.iter().any(|f| f == line))
        .collect();
    assert!(new.is_empty(), "{what}:\n{}", new.join("\n"));
    assert!(
        gone.is_empty(),
        "no longer there, so take them off the list:\n{}",
        gone.join("\n")
    );
}

/// The groups of files of which each can be reached from each other.
fn circles(imports: &BTreeSet<Import>) -> Vec<Vec<ModulePath>> {
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
    };
    let imports = BTreeSet::from([
        import("a", "b"),
        import("b", "c"),
        import("c", "b"),
        import("c", "d"),
    ]);
    assert_eq!(
        circles(&imports),
        [[vec!["b".to_owned()], vec!["c".to_owned()]]]
    );
}
