//! Commands that are no numbers: a radio that drops out, or a filter that has diverged, must not end the servo.

use super::{must, rows, works};
use crate::support::{arg, run};
use servoid_test_support::tools::missing;
use std::path::Path;
use std::process::Command;

/// The aircraft's servo as `file` for a target.
fn export(target: &str, more: &[&str], folder: &Path, file: &str) {
    let out = folder.join(file);
    let args = ["export", arg(&super::servo_model::AIRCRAFT.file), "--to"];
    let rest = [target, "--name", "a", "-q", "-o", arg(&out)];
    run(&[&args[..], &rest, more].concat());
}

/// Two servos under the same command, in one of which some of its samples are no numbers.
const MAIN: &str = r#"
#include <math.h>
#include <stdio.h>
#include "linear.h"
#include "machine.h"

int main(void)
{
    servo_a_fir fir[2];
    servo_a_ss ss[2];
    servo_a_state servo[2];
    for (unsigned k = 0; k < 2; k++) {
        servo_a_fir_reset(&fir[k], 1);
        servo_a_ss_reset(&ss[k], 1);
        servo_a_reset(&servo[k], 1);
    }
    for (unsigned k = 0; k < 300; k++) {
        const servo_a_real right = (servo_a_real)(k / 40 % 2 ? 3 : -2);
        const servo_a_real odd[3] = { (servo_a_real)NAN, (servo_a_real)INFINITY, (servo_a_real)-INFINITY };
        const servo_a_real command = k % 40 > 0 ? odd[k % 3] : right;
        printf("%.9g %.9g ", (double)servo_a_fir_step(&fir[0], right), (double)servo_a_fir_step(&fir[1], command));
        printf("%.9g %.9g ", (double)servo_a_ss_step(&ss[0], right), (double)servo_a_ss_step(&ss[1], command));
        printf("%.9g %.9g\n", (double)servo_a_step(&servo[0], right), (double)servo_a_step(&servo[1], command));
    }
    return 0;
}
"#;

#[test]
fn headers_hold_the_last_number() {
    if !works("cc", &["--version"]) {
        return missing("the C headers", "there is no C compiler 'cc'");
    }
    let folder = tempfile::tempdir().unwrap();
    export("c", &[], folder.path(), "linear.h");
    export("c", &["--servo-model"], folder.path(), "machine.h");
    let [main, program] = ["main.c", "main"].map(|name| folder.path().join(name));
    std::fs::write(&main, MAIN).unwrap();
    let mut build = Command::new("cc");
    build.args(["-std=c99", "-pedantic", "-Wall", "-Wextra", "-Werror"]);
    must(build.arg(main).arg("-o").arg(&program).arg("-lm"));
    for row in rows(&must(&mut Command::new(program))) {
        let pairs = row.chunks(2);
        pairs.for_each(|pair| assert_eq!(pair[0], pair[1], "{row:?}"));
    }
}

const PYTHON: &str = r"
import importlib.util, math, sys
spec = importlib.util.spec_from_file_location('a', sys.argv[1])
servo = importlib.util.module_from_spec(spec)
spec.loader.exec_module(servo)
right = [1.0] + [3.0] * 200 + [-2.0] * 200
wrong = [u if k % 7 in (0, 1) else (math.nan, math.inf, -math.inf)[k % 3] for k, u in enumerate(right)]
assert servo.simulate(right[:200]) == servo.simulate(wrong[:200])
assert all(map(math.isfinite, servo.simulate(wrong)))
";

#[test]
fn the_python_module_holds_the_last_number() {
    if !works("python3", &["--version"]) {
        return missing("the servo model in Python", "there is no python3");
    }
    let folder = tempfile::tempdir().unwrap();
    export("python", &["--servo-model"], folder.path(), "a.py");
    let module = folder.path().join("a.py");
    must(Command::new("python3").args(["-c", PYTHON]).arg(module));
}

const OCTAVE: &str = "right = [1, 3 * ones(1, 200)]; wrong = right; wrong(5:9) = [NaN, Inf, -Inf, NaN, NaN]; \
    assert(servo_a(right), servo_a(wrong));";

#[test]
fn the_function_of_octave_holds_the_last_number() {
    if !works("octave-cli", &["--version"]) {
        return missing("the servo model in Octave", "there is no octave-cli");
    }
    let folder = tempfile::tempdir().unwrap();
    export("matlab", &["--servo-model"], folder.path(), "servo_a.m");
    let mut octave = Command::new("octave-cli");
    octave.args(["-q", "--no-init-file", "--eval", OCTAVE]);
    must(octave.current_dir(folder.path()));
}
