//! What people read, word for word: help, summaries, advice, plans, comparisons.
//!
//! A text that changed on purpose is taken over with
//! `INSTA_UPDATE=always cargo test -p servoid --test integration wording`; then read the difference that git
//! shows. The texts lie in `snapshots/`.

use crate::support::{arg, run, servoid};
use std::path::Path;

/// What a command prints in a folder, results first, then what it says beside them.
fn printed(folder: &Path, args: &[&str]) -> String {
    let output = servoid(args).current_dir(folder).output();
    let output = output.expect("it can be started");
    let [results, remarks] = [output.stdout, output.stderr]
        .map(|text| String::from_utf8(text).expect("it prints UTF-8"));
    format!("$ servoid {}\n{results}---\n{remarks}", args.join(" "))
}

fn simulated(folder: &Path, servo: &str, further: &[&str]) -> String {
    let name = format!("{servo}.csv");
    let file = folder.join(&name);
    let args = [
        "simulate",
        "--servo",
        servo,
        "--seed",
        "1",
        "-o",
        arg(&file),
    ];
    run(&[&args, further].concat());
    name
}

#[test]
fn help() {
    let all = run(&["--help"]);
    insta::assert_snapshot!("help", all);
    let commands = all.lines().skip_while(|line| *line != "Commands:").skip(1);
    let names = commands
        .take_while(|line| line.starts_with("  "))
        .filter(|line| !line.starts_with("   "))
        .filter_map(|line| line.split_whitespace().next())
        .filter(|name| *name != "help");
    let mut count = 0;
    for name in names {
        insta::assert_snapshot!(format!("help_{name}"), run(&[name, "--help"]));
        count += 1;
    }
    assert!(count > 10, "{all}");
}

#[test]
fn a_summary() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = simulated(folder.path(), "bench", &[]);
    insta::assert_snapshot!("summary", printed(folder.path(), &["identify", &file]));
}

#[test]
fn advice() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = simulated(
        folder.path(),
        "aircraft",
        &["--reference", "sweep", "--length", "6"],
    );
    insta::assert_snapshot!("advice_sweep", printed(folder.path(), &["identify", &file]));
    let short = ["identify", file.as_str(), "--settling", "21"];
    insta::assert_snapshot!("advice_short_memory", printed(folder.path(), &short));
}

#[test]
fn a_plan() {
    let folder = tempfile::tempdir().expect("a folder");
    let plan = ["plan", "--servo", "linear", "--band", "0.3"];
    insta::assert_snapshot!("plan", printed(folder.path(), &plan));
}

#[test]
fn a_comparison() {
    let folder = tempfile::tempdir().expect("a folder");
    let [bench, aircraft] = ["bench", "aircraft"].map(|servo| simulated(folder.path(), servo, &[]));
    let compare = ["compare", &bench, &aircraft];
    insta::assert_snapshot!("comparison", printed(folder.path(), &compare));
}
