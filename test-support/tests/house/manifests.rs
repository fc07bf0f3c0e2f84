//! The arrows between the crates go one way, the manifest promises the compiler that is tested, and who cites servoid names its version.

use crate::workspace;
use std::fs;
use toml::{Table, Value};

/// The crates and those that each may use, the lowest first.
const CRATES: [(&str, &[&str]); 12] = [
    ("fft", &[]),
    ("linear-algebra", &[]),
    ("flash-image", &[]),
    ("dynamics", &[]),
    ("protocol", &[]),
    ("firmware", &["servoid-protocol"]),
    (
        "simulator",
        &["servoid-dynamics", "servoid-firmware", "servoid-protocol"],
    ),
    (
        "identification",
        &["servoid-dynamics", "servoid-fft", "servoid-linear-algebra"],
    ),
    ("client", &["servoid-protocol"]),
    (
        "host",
        &[
            "servoid-client",
            "servoid-dynamics",
            "servoid-fft",
            "servoid-firmware",
            "servoid-flash-image",
            "servoid-identification",
            "servoid-protocol",
            "servoid-simulator",
        ],
    ),
    (
        "virtual-board",
        &[
            "servoid-flash-image",
            "servoid-protocol",
            "servoid-simulator",
        ],
    ),
    ("python", &["servoid", "servoid-identification"]),
];

fn table(path: &str) -> Table {
    let text = fs::read_to_string(workspace().join(path)).expect("the file can be read");
    text.parse().expect("it is TOML")
}

/// Dependencies of a crate that are crates of the workspace; those of tests are free.
fn of_the_house(manifest: &Table) -> Vec<String> {
    let plain = manifest.get("dependencies").and_then(Value::as_table);
    let build = manifest.get("build-dependencies").and_then(Value::as_table);
    let targets = manifest.get("target").and_then(Value::as_table);
    let of_targets = targets
        .into_iter()
        .flat_map(Table::values)
        .filter_map(|target| target.get("dependencies")?.as_table());
    let all = plain.into_iter().chain(build).chain(of_targets);
    let names = all.flat_map(Table::keys).cloned();
    names
        .filter(|name| name.starts_with("servoid") || name == "virtual-board")
        .collect()
}

#[test]
fn crates_use_only_crates_below() {
    for (folder, allowed) in CRATES {
        let used = of_the_house(&table(&format!("{folder}/Cargo.toml")));
        for name in used {
            assert!(
                allowed.contains(&name.as_str()),
                "{folder} must not use {name}"
            );
        }
    }
}

/// Users read `rust-version`, CI tests the pin: an older compiler is never promised.
#[test]
fn the_promised_compiler_is_the_tested_one() {
    let pin = table("rust-toolchain.toml")["toolchain"]["channel"].clone();
    let promised = table("Cargo.toml")["workspace"]["package"]["rust-version"].clone();
    let pin = pin.as_str().expect("a channel is a text");
    let promised = promised.as_str().expect("a version is a text");
    assert_eq!(pin, promised, "rust-toolchain.toml and Cargo.toml differ");
}

/// Who cites servoid names the version that the program prints.
#[test]
fn the_cited_version_is_that_of_the_program() {
    let version = table("Cargo.toml")["workspace"]["package"]["version"].clone();
    let version = version.as_str().expect("a version is a text");
    let cited = fs::read_to_string(workspace().join("CITATION.cff")).expect("it can be read");
    assert!(
        cited.contains(&format!("\nversion: {version}\n")),
        "{version}"
    );
}
