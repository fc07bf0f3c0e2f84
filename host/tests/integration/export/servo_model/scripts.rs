//! The equation in Python, Octave and Julia.

use super::super::scripts::{JULIA_SYNTAX, literal};
use super::super::{must, rows, works};
use super::subjects::{Exported, SERVOS, from_ends};
use servoid_test_support::tools::{missing, skipped};
use std::fmt::Write;
use std::path::Path;
use std::process::Command;

/// Sums and products in another order: rounding that the steps carry on, some thousands of them.
const ROUNDING: f64 = 1e-9;

/// The equation by steps of at most 0.03/ω: the scheme is of second order, so to a few thousandths of a stroke, and a shaft that sticks
/// does so a step earlier or later; where strokes turn round again and again, these add up.
const STEPS: f64 = 0.015;

/// All servos in files of a language.
fn exports(target: &str, ending: &str, folder: &Path) -> Vec<Exported> {
    let write = |servo: &super::subjects::Servo| {
        let exported = servo.export(target, folder, &[]);
        let file = folder.join(format!("servo_{}.{ending}", servo.name));
        std::fs::write(file, &exported.text).unwrap();
        exported
    };
    SERVOS.iter().map(write).collect()
}

/// Rows of positions at the ends of steps, a row for each servo.
fn check(exports: &[Exported], printed: &str) {
    check_each(1, exports, printed);
}

/// The same for each servo that is so many after the one before.
fn check_each(apart: usize, exports: &[Exported], printed: &str) {
    let rows = rows(printed);
    assert_eq!(rows.len(), exports.len());
    let servos = SERVOS.iter().step_by(apart);
    for ((exported, servo), ends) in exports.iter().zip(servos).zip(rows) {
        exported.check(servo.name, &from_ends(exported, &ends), ROUNDING);
        exported.check_rest(servo.name, ends[0], ROUNDING);
        let share = exported.stated / exported.largest_stroke();
        assert!(share < STEPS, "{}: {share}", servo.name);
    }
}

#[test]
fn python_modules_move_as_the_servo_model() {
    if !works("python3", &["--version"]) {
        return missing("the servo model in Python", "there is no python3");
    }
    let folder = tempfile::tempdir().unwrap();
    let exports = exports("python", "py", folder.path());
    let mut script = "import sys\nsys.path.insert(0, sys.argv[1])\n".to_owned();
    // Its numbers are not those of Python: their truth values have no difference.
    script += "try:\n    import numpy\nexcept ImportError:\n    numpy = None\n";
    for (servo, exported) in SERVOS.iter().zip(&exports) {
        let _infallible = writeln!(
            script,
            "import servo_{name} as servo\nassert servo.NAME == '{name}'\nif numpy:\n    assert servo.simulate(numpy.zeros(2)) == servo.simulate([0.0, 0.0])\nprint(*map(repr, servo.simulate({})))",
            literal(&exported.trial.command()),
            name = servo.name,
        );
    }
    script += "assert servo.simulate([]) == []\n";
    let file = folder.path().join("run.py");
    std::fs::write(&file, script).unwrap();
    check(
        &exports,
        &must(Command::new("python3").arg(file).arg(folder.path())),
    );
}

#[test]
#[ignore = "a minute: cargo test -p servoid --test integration -- --ignored in_octave"]
fn matlab_functions_move_as_the_servo_model_in_octave() {
    if !works("octave-cli", &["--norc", "--eval", "1;"]) {
        return missing("the servo model in MATLAB", "there is no octave-cli");
    }
    let folder = tempfile::tempdir().unwrap();
    // Each fourth servo: Octave takes ten seconds for one.
    let exports: Vec<Exported> = exports("matlab", "m", folder.path())
        .into_iter()
        .step_by(4)
        .collect();
    let mut script = String::new();
    for (servo, exported) in SERVOS.iter().step_by(4).zip(&exports) {
        // In two parts, to see that the state goes on.
        let _infallible = writeln!(
            script,
            "u = {};\n[first, state] = servo_{name}(u(1:777));\nprintf('%.17g ', [first, servo_{name}(u(778:end), state)]); printf('\\n');",
            literal(&exported.trial.command()),
            name = servo.name,
        );
    }
    std::fs::write(folder.path().join("run_it.m"), script).unwrap();
    let mut octave = Command::new("octave-cli");
    octave
        .args(["--norc", "--eval", "run_it"])
        .current_dir(folder.path());
    check_each(4, &exports, &must(&mut octave));
}

#[test]
fn julia_modules_move_as_the_servo_model_or_are_at_least_julia() {
    let folder = tempfile::tempdir().unwrap();
    let exports = exports("julia", "jl", folder.path());
    if works("julia", &["--version"]) {
        let mut script = String::new();
        for (servo, exported) in SERVOS.iter().zip(&exports) {
            let _infallible = writeln!(
                script,
                "include(joinpath(ARGS[1], \"servo_{name}.jl\"))\nprintln(join(repr.(servo_{name}.simulate({})), \" \"))",
                literal(&exported.trial.command()),
                name = servo.name,
            );
        }
        let file = folder.path().join("run.jl");
        std::fs::write(&file, script).unwrap();
        let mut julia = Command::new("julia");
        julia.arg("--startup-file=no").arg(file).arg(folder.path());
        return check(&exports, &must(&mut julia));
    }
    if !works("python3", &["-c", "import tree_sitter, tree_sitter_julia"]) {
        let reason = "there is neither julia nor python3 with tree-sitter-julia";
        return missing("the servo model in Julia", reason);
    }
    // No registry that the continuous integration may use has Julia.
    skipped(
        "running the servo model in Julia",
        "there is no julia; its syntax is checked",
    );
    for servo in SERVOS {
        let file = folder.path().join(format!("servo_{}.jl", servo.name));
        must(Command::new("python3").args(["-c", JULIA_SYNTAX]).arg(file));
    }
}
