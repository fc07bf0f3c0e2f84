//! The program `virtual-board`: its messages where it cannot run.

use assert_cmd::Command;
use std::time::Duration;

/// Runs the program, requires that it fails, returns its message.
fn refusal(args: &[&str]) -> String {
    let mut command = Command::cargo_bin("virtual-board").unwrap();
    let output = command
        .args(args)
        .timeout(Duration::from_secs(30))
        .output()
        .unwrap();
    assert!(!output.status.success(), "{args:?}");
    assert!(output.stdout.is_empty(), "{args:?}");
    String::from_utf8(output.stderr).unwrap()
}

#[test]
fn what_cannot_be_done_is_said_in_a_sentence() {
    for (args, expected) in [
        (&["--elf", "nowhere"][..], "nowhere cannot be read"),
        (&["--elf", "Cargo.toml"], "no image for an STM32F103C8"),
        (&["--servo", "plane"], "choose bench, aircraft or linear"),
        (&["--fault", "melt"], "there is no fault 'melt'"),
        (
            &["--elf", "Cargo.toml", "--servo", "bench?baud=9600"],
            "leave out baud",
        ),
    ] {
        let said = refusal(args);
        assert!(said.contains(expected), "{args:?}: {said}");
        assert!(!said.contains("panicked"), "{said}");
    }
}
