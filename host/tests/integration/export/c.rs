//! The C header, compiled as strictly as C99 goes.

use super::{SUBJECT, apart, export, largest_error, must, rows, trial, works};
use crate::support::{arg, run};
use servoid_test_support::tools::missing;
use std::fmt::Write;
use std::path::Path;
use std::process::Command;

const MAIN: &str = r#"
#include <stdio.h>
#define SERVO_BENCH_1_WITH_THETA
#include "servo_bench_1.h"
#include "input.h"

int main(void)
{
    servo_bench_1_fir fir;
    servo_bench_1_ss ss;
    servo_bench_1_fir_reset(&fir, 0);
    servo_bench_1_ss_reset(&ss, 0);
    for (unsigned k = 0; k < sizeof input / sizeof *input; k++) {
        double a = (double)servo_bench_1_fir_step(&fir, (servo_bench_1_real)input[k]);
        double b = (double)servo_bench_1_ss_step(&ss, (servo_bench_1_real)input[k]);
        printf("%.17g %.17g\n", a, b);
    }
    /* At rest at a command the servo stays where its gain puts it. */
    servo_bench_1_fir_reset(&fir, 2);
    servo_bench_1_ss_reset(&ss, 2);
    for (unsigned k = 0; k < 50; k++) {
        double a = (double)servo_bench_1_fir_step(&fir, 2);
        double b = (double)servo_bench_1_ss_step(&ss, 2);
        printf("%.17g %.17g\n", a, b);
    }
    for (unsigned k = 0; k < SERVO_BENCH_1_PARAMETERS; k++) {
        printf("%.17g %.17g\n", servo_bench_1_theta[k], servo_bench_1_theta_covariance[k][0]);
    }
    return 0;
}
"#;

/// Both responses to an input, then 50 samples at rest at 2, then theta and the first column of its covariance.
fn responses(folder: &Path, real: &str, input: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let mut array = String::from("static const double input[] = {");
    for value in input {
        let _infallible = write!(array, "{value:?}, ");
    }
    std::fs::write(folder.join("input.h"), array + "};\n").unwrap();
    std::fs::write(folder.join("main.c"), MAIN).unwrap();
    let program = folder.join(format!("main-{real}"));
    must(
        Command::new("cc")
            .args([
                "-std=c99",
                "-pedantic",
                "-Wall",
                "-Wextra",
                "-Werror",
                "-O1",
            ])
            .args(["-Wshadow", "-Wconversion", "-Wdouble-promotion"])
            .arg(format!("-DSERVO_BENCH_1_REAL={real}"))
            .args([&folder.join("main.c")])
            .arg("-o")
            .arg(&program),
    );
    let rows = rows(&must(&mut Command::new(&program)));
    rows.iter().map(|row| (row[0], row[1])).unzip()
}

#[test]
fn the_header_gives_the_model_itself() {
    if !works("cc", &["--version"]) {
        return missing("the C header", "there is no C compiler 'cc'");
    }
    let folder = tempfile::tempdir().unwrap();
    export("c", folder.path(), "servo_bench_1.h");
    let (subject, taps) = (&*SUBJECT, SUBJECT.model.step.value.len());
    let step = vec![1.0; taps];
    let (mut fir, mut ss) = responses(folder.path(), "double", &step);
    // The same sums in another order: rounding of some hundred terms.
    assert!(apart(&fir[..taps], &subject.model.step.value) < 1e-12);
    assert!(apart(&ss[..taps - 1], &fir[..taps - 1]) <= largest_error());
    let discrete = subject.flight.transfer.discrete(subject.model.timing());
    assert!(apart(&ss[..taps], &discrete.simulate(&step, 0.0)) < 1e-12);
    let (theta, covariance) = (fir.split_off(taps + 50), ss.split_off(taps + 50));
    assert_eq!(theta, subject.model.theta);
    let bounds = subject.model.bounds.valid().unwrap();
    let first: Vec<f64> = bounds.covariance.iter().map(|row| row[0]).collect();
    assert_eq!(covariance, first);
    let gain = subject.model.step.value[taps - 1];
    assert!(fir[taps..].iter().all(|y| (y - 2.0 * gain).abs() < 1e-12));
    let gain = subject.flight.transfer.gain;
    assert!(ss[taps..].iter().all(|y| (y - 2.0 * gain).abs() < 1e-9));

    let (input, expected) = trial();
    let (fir, ss) = responses(folder.path(), "double", &input);
    assert!(apart(&fir[..input.len()], &expected) < 1e-11);
    let (single, single_ss) = responses(folder.path(), "float", &input);
    // Some 200 products of size 1, each rounded to 24 bits (6e-8).
    assert!(apart(&single, &fir) < 5e-5);
    assert!(apart(&single_ss, &ss) < 5e-5);
}

/// Both headers of one servo in one program, in either order, as C and as C++.
#[test]
fn both_models_of_one_servo_can_be_included() {
    const BOTH: &str = r"
int main(void)
{
    servo_a_fir fir;
    servo_a_state servo;
    servo_a_fir_reset(&fir, 0);
    servo_a_reset(&servo, 0);
    /* Ten minutes of steps, counted in either way. */
    const long steps = (long)(600 / SERVO_A_STEP_S + 0.5);
    const double apart = (double)steps * servo_a_step_s - (double)steps * SERVO_A_STEP_S;
    return servo_a_fir_step(&fir, 1) + servo_a_step(&servo, 1) > 1e9f || apart < 0 || apart > 0;
}
";
    let folder = tempfile::tempdir().unwrap();
    let file = &super::servo_model::AIRCRAFT.file;
    for (name, more) in [("linear.h", &[][..]), ("machine.h", &["--servo-model"])] {
        let out = folder.path().join(name);
        run(&[
            &["export", arg(file), "--to", "c", "-q", "-o", arg(&out)],
            more,
        ]
        .concat());
    }
    for (compiler, standard, ending) in [("cc", "-std=c99", "c"), ("c++", "-std=c++17", "cpp")] {
        if !works(compiler, &["--version"]) {
            missing("both C headers", "a compiler is not there");
            continue;
        }
        for order in [["linear.h", "machine.h"], ["machine.h", "linear.h"]] {
            let includes = order.map(|name| format!("#include \"{name}\"\n")).concat();
            let main = folder.path().join(format!("both.{ending}"));
            std::fs::write(&main, includes + BOTH).unwrap();
            let program = folder.path().join("both");
            let mut build = Command::new(compiler);
            build.args([standard, "-pedantic", "-Wall", "-Wextra", "-Werror"]);
            build.args(["-Wshadow", "-Wdouble-promotion"]).arg(main);
            must(build.arg("-o").arg(&program).arg("-lm"));
            must(&mut Command::new(program));
        }
    }
}
