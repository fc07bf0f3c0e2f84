//! The equation as a C99 header, compiled as strictly as C99 goes.

use super::super::{must, rows, works};
use super::subjects::{Exported, SERVOS, from_ends, prose};
use servoid_test_support::tools::missing;
use std::fmt::Write;
use std::path::Path;
use std::process::Command;

/// A program that prints the positions of all servos at the ends of steps, a line each.
fn program(exports: &[Exported]) -> String {
    let mut text = String::from("#include <stdio.h>\n");
    for servo in SERVOS {
        let _infallible = writeln!(text, "#include \"servo_{}.h\"", servo.name);
    }
    text += "int main(void)\n{\n";
    for (servo, exported) in SERVOS.iter().zip(exports) {
        // Runs of the same command: every step as a number would be long.
        let commands = exported.trial.command();
        let runs: Vec<String> = commands
            .chunk_by(|a, b| a == b)
            .map(|run| format!("{{ {:?}, {} }}", run[0], run.len()))
            .collect();
        let _infallible = writeln!(
            text,
            r#"    {{
        static const struct {{ double command; unsigned steps; }} runs[] = {{ {runs} }};
        servo_{name}_state servo;
        servo_{name}_reset(&servo, (servo_{name}_real)runs[0].command);
        for (unsigned n = 0; n < sizeof runs / sizeof *runs; n++) {{
            for (unsigned k = 0; k < runs[n].steps; k++) {{
                printf("%.17g ", (double)servo_{name}_step(&servo, (servo_{name}_real)runs[n].command));
            }}
        }}
        printf("\n");
    }}"#,
            runs = runs.join(", "),
            name = servo.name,
        );
    }
    text + "    return 0;\n}\n"
}

fn positions(folder: &Path, exports: &[Exported], real: &str) -> Vec<Vec<f64>> {
    let main = folder.join("main.c");
    std::fs::write(&main, program(exports)).unwrap();
    let binary = folder.join(format!("main-{real}"));
    let mut cc = Command::new("cc");
    cc.args(["-std=c99", "-pedantic", "-Wall", "-Wextra", "-Werror"])
        .args(["-O1", "-Wshadow", "-Wconversion", "-Wno-float-conversion"]);
    for servo in SERVOS {
        let name = servo.name.to_ascii_uppercase();
        cc.arg(format!("-DSERVO_{name}_REAL={real}"));
    }
    must(cc.arg(main).arg("-o").arg(&binary).arg("-lm"));
    let ends = rows(&must(&mut Command::new(binary)));
    let pairs = exports.iter().zip(ends);
    pairs
        .map(|(exported, ends)| from_ends(exported, &ends))
        .collect()
}

#[test]
fn headers_move_as_the_servo_model() {
    if !works("cc", &["--version"]) {
        return missing("the servo model in C", "there is no C compiler 'cc'");
    }
    let folder = tempfile::tempdir().unwrap();
    let write = |servo: &super::subjects::Servo| {
        let exported = servo.export("c", folder.path(), &[]);
        let file = folder.path().join(format!("servo_{}.h", servo.name));
        std::fs::write(file, &exported.text).unwrap();
        exported
    };
    let exports: Vec<Exported> = SERVOS.iter().map(write).collect();
    let double = positions(folder.path(), &exports, "double");
    let single = positions(folder.path(), &exports, "float");
    for (k, servo) in SERVOS.iter().enumerate() {
        // Rounding of some thousand steps.
        exports[k].check(servo.name, &double[k], 1e-9);
        // Positions of some 10 deg to 24 bits are rounded by 1e-6 of the stroke in each step; friction and damping forget it.
        exports[k].check(servo.name, &single[k], 1e-3);
        exports[k].check_rest(servo.name, double[k][1], 1e-9);
        exports[k].check_rest(servo.name, single[k][1], 1e-5);
    }
}

/// Steps of another length, from a fifth of the integrator's own to the longest.
#[test]
fn other_steps_state_their_difference() {
    let folder = tempfile::tempdir().unwrap();
    let servo = SERVOS[1];
    let stated = ["0.1", "2", "10"].map(|step| {
        let exported = servo.export("c", folder.path(), &["--step-ms", step]);
        assert!(prose(&exported.text).contains(&format!("with steps of {step}")));
        exported.stated / exported.largest_stroke()
    });
    // Second order: the difference falls at least by 5 where the step falls by 5.
    assert!(stated[0] < 1e-3 && stated[2] < 0.05, "{stated:?}");
    assert!(stated[1] < stated[2] / 5.0, "{stated:?}");
}
