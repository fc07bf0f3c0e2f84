//! Exports: each is run, or at least parsed, by the program that it is for. A test whose program is
//! not installed says so on the terminal and passes.

mod c;
mod draws;
mod jsbsim;
mod no_number;
mod scripts;
mod servo_model;
mod texts;

use crate::support::{arg, run};
use servoid_identification::flight_model;
use servoid_identification::flight_model::{FlightModel, FlightModelOptions};
use servoid_identification::results::Model;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::LazyLock;

/// What several tests share: a linear servo, identified once.
struct Subject {
    _folder: tempfile::TempDir,
    file: PathBuf,
    model: Model,
    flight: FlightModel,
}

static SUBJECT: LazyLock<Subject> = LazyLock::new(|| {
    let folder = tempfile::tempdir().unwrap();
    let (record, file) = (
        folder.path().join("a.csv"),
        folder.path().join("bench 1.json"),
    );
    run(&["simulate", "--servo", "linear", "-o", arg(&record)]);
    run(&["identify", arg(&record), "-o", arg(&file)]);
    let model: Model = serde_json::from_str(&std::fs::read_to_string(&file).unwrap()).unwrap();
    let flight = flight_model::of_model(&model, &FlightModelOptions::default()).unwrap();
    Subject {
        _folder: folder,
        file,
        model,
        flight,
    }
});

/// The subject, exported into a folder under the name that its identifier has.
fn export(target: &str, folder: &Path, file: &str) -> PathBuf {
    let path = folder.join(file);
    run(&[
        "export",
        arg(&SUBJECT.file),
        "--to",
        target,
        "-o",
        arg(&path),
        "-q",
    ]);
    path
}

/// Whether a command can be started and succeeds.
fn works(program: &str, args: &[&str]) -> bool {
    Command::new(program)
        .args(args)
        .output()
        .is_ok_and(|output| output.status.success())
}

/// The output of a program that must succeed.
fn must(command: &mut Command) -> String {
    let Output {
        status,
        stdout,
        stderr,
    } = command.output().expect("it can be started");
    let (stdout, stderr) = (
        String::from_utf8_lossy(&stdout),
        String::from_utf8_lossy(&stderr),
    );
    assert!(status.success(), "{command:?}:\n{stdout}\n{stderr}");
    stdout.into_owned()
}

/// Rows of numbers, as the programs print them.
fn rows(text: &str) -> Vec<Vec<f64>> {
    text.lines()
        .map(|line| {
            let numbers = line.split_whitespace().map(|word| word.parse().unwrap());
            numbers.collect()
        })
        .collect()
}

/// Largest difference of two curves.
fn apart(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter()
        .zip(b)
        .map(|(a, b)| (a - b).abs())
        .fold(0.0, f64::max)
}

/// How far the step response of the low-order model may be from the identified one, by what the
/// export itself says. The last sample gathers what comes after it and is left out by the callers.
fn largest_error() -> f64 {
    let gain = SUBJECT.model.step.value.last().unwrap().abs();
    // The figure is printed in full; what is added is rounding.
    SUBJECT.flight.largest_error_percent / 100.0 * gain + 1e-9
}

/// An input of many levels, and what the model makes of it when it is at rest at 0 before.
fn trial() -> (Vec<f64>, Vec<f64>) {
    let input: Vec<f64> = (0..700)
        .map(|k| f64::from(k * k / 7000 % 7) - 3.0)
        .collect();
    let model = &SUBJECT.model;
    let expected = model.simulate_input(&input, Some(0.0));
    let expected = expected.iter().map(|y| y - model.offset).collect();
    (input, expected)
}
