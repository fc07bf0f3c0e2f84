//! One servo recorded twice is never called different; `examples/verdict_pairs.rs` is the long version.

use crate::support::{arg, run};
use serde_json::{Value, json};
use servoid_identification::comparison::Verdict;
use servoid_test_support::servos::{Linear, PERIOD, measured, respond_by_stroke, staircase};
use servoid_test_support::trials::verdicts::{compare_pairs, count};
use std::path::Path;

#[test]
fn one_servo_twice_is_the_same_whatever_scatters_and_a_loaded_one_is_not() {
    // In 100 pairs each, none was called different, and one undecided with scatter of the clock.
    for servo in ["bench", "bench?scatter=all"] {
        let found = compare_pairs([servo; 2], 0..4);
        assert_eq!(count(&found, Verdict::Different), 0, "{servo}");
        assert!(count(&found, Verdict::Same) >= 3, "{servo}");
    }
    let found = compare_pairs(["bench?scatter=all", "aircraft?scatter=all"], 0..2);
    assert_eq!(count(&found, Verdict::Different), 2);
    // The simulated load takes about 30 % of the step away at its worst moment.
    let mut bounds = found.iter().map(|c| c.bounds.valid().unwrap());
    assert!(bounds.all(|bounds| bounds.difference_percent.at_least > 25.0));
}

/// Files of another program under the staircase, whose holds are whole frames of pulses.
#[test]
fn a_delay_that_waits_for_pulses_may_make_is_left_open_unless_no_command_waits() {
    let dir = tempfile::tempdir().unwrap();
    let input = staircase();
    let written = |name: &str, servo: &Linear, seed: u64| {
        let clean = respond_by_stroke(servo, servo, &input, -5.0, 0.0);
        let measured = measured(&clean, 1.0, seed);
        let rows = (0..)
            .map(|k| f64::from(k) * PERIOD)
            .zip(input.iter().zip(measured));
        let rows: String = rows
            .map(|(t, (u, y))| format!("{t:.3},{u},{y:.4}\n"))
            .collect();
        let file = dir.path().join(name);
        std::fs::write(&file, "t_s,command_deg,angle_deg\n".to_owned() + &rows).unwrap();
        file
    };
    let first = written("a.csv", &Linear::second_order(0.97, 0.0255, 0.5, 60.0), 1);
    let later = written(
        "later.csv",
        &Linear::second_order(0.97, 0.0355, 0.5, 60.0),
        2,
    );
    let slower = written(
        "slower.csv",
        &Linear::second_order(0.97, 0.0255, 0.5, 48.0),
        3,
    );
    let columns = [
        "-q",
        "--json",
        "--input",
        "command_deg",
        "--output",
        "angle_deg",
    ];
    let compared = |b: &Path, further: &[&str]| -> Value {
        let sides = ["compare", arg(&first), arg(b), "--no-servo-model"];
        serde_json::from_str(&run(&[&sides[..], &columns[..], further].concat())).unwrap()
    };
    let (left_open, stated) = (
        compared(&later, &[]),
        compared(&later, &["--exact-command"]),
    );
    assert_eq!(
        [&left_open["verdict"], &left_open["may_be_waits"]],
        [&json!("undecided"), &json!(true)]
    );
    let summary = left_open["summary"].as_str().unwrap();
    assert!(
        summary.contains(
            "commands that wait for the next of pulses on a clock of their own may make all of it but what counts as the same"
        ),
        "{summary}"
    );
    assert!(
        left_open["advice"][0]["finding"]
            .as_str()
            .unwrap()
            .contains("up to 20 ms of a difference in time")
    );
    assert_eq!(
        [&stated["verdict"], &stated["may_be_waits"]],
        [&json!("different"), &json!(false)]
    );
    assert_eq!(compared(&slower, &[])["verdict"], "different");
}
