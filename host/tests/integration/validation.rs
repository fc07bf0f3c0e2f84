//! A model against recordings that differ from its own by one thing.

use crate::support::{SHORT_STAIRS, arg, json, modelled, run};
use std::path::{Path, PathBuf};

/// Another recording of the servo as a table of another program, with `change` made to time, command and position.
fn changed(recording: &Path, table: &Path, change: impl Fn([f64; 3]) -> [f64; 3]) {
    let text = std::fs::read_to_string(recording).unwrap();
    let rows = text
        .lines()
        .filter(|line| line.starts_with(|c: char| c.is_ascii_digit()));
    let row = |line: &str| {
        let cells: Vec<f64> = line.split(',').map(|cell| cell.parse().unwrap()).collect();
        let [time, command, position] = change([cells[1], cells[2], cells[3]]);
        format!("{time:.6},{command:.6},{position:.6}\n")
    };
    let rows: String = rows.map(row).collect();
    std::fs::write(table, format!("t_s,command,position_deg\n{rows}")).unwrap();
}

/// A model of the bench servo, and another recording of it.
fn model_and_other(dir: &Path) -> [PathBuf; 2] {
    let of_seed = |seed: &'static str| [&SHORT_STAIRS[..], &["--seed", seed]].concat();
    let model = modelled(dir, "own", "bench", &of_seed("1"));
    let other = dir.join("other.csv");
    let simulate = ["simulate", "-q", "--servo", "bench", "-o", arg(&other)];
    run(&[&simulate[..], &of_seed("2")].concat());
    [model, other]
}

/// What validation says of the recording with this change, in one line.
fn said(dir: &Path, files: &[PathBuf; 2], change: impl Fn([f64; 3]) -> [f64; 3]) -> String {
    said_with(dir, files, change, &[])
}

/// The same with more options.
fn said_with(
    dir: &Path,
    [model, other]: &[PathBuf; 2],
    change: impl Fn([f64; 3]) -> [f64; 3],
    more: &[&str],
) -> String {
    let table = dir.join("table.csv");
    changed(other, &table, change);
    let named = "--input command --output position_deg --time t_s".split(' ');
    let args = ["validate", "-q", arg(model), arg(&table)];
    let args = args.into_iter().chain(named).chain(more.iter().copied());
    let args: Vec<&str> = args.collect();
    run(&args).split_whitespace().collect::<Vec<_>>().join(" ")
}

/// The servo model begins where the recording does. From there it moves first, which an offset does not explain.
#[test]
fn a_zero_that_moved_by_any_angle_is_an_offset() {
    let dir = tempfile::tempdir().unwrap();
    let files = model_and_other(dir.path());
    for moved in [1.0, 7.0, -20.0] {
        let said = said(dir.path(), &files, |[t, u, y]| [t, u, y + moved]);
        let (_, servo) = said.split_once("! The servo model does not hold").unwrap();
        let (_, offset) = servo.split_once("It is an offset of ").expect(servo);
        let (offset, left) = offset
            .split_once(" deg, without which the error is ")
            .unwrap();
        let number = |text: &str| text.split(' ').next().unwrap().parse::<f64>().unwrap();
        // The noise of the recording is 0.05 deg, and what is left is as large whatever the angle.
        assert!((number(offset) - moved).abs() < 0.05, "{moved}: {said}");
        assert!(number(left) < 0.07, "{moved}: {said}");
    }
}

/// Each command is written at some moment of the frame of 20 ms, ten rows, before the pulse with which the servo gets it.
#[test]
fn commands_that_wait_for_pulses_are_held_at_them_where_their_frame_is_stated() {
    let dir = tempfile::tempdir().unwrap();
    let [model, other] = model_and_other(dir.path());
    let table = dir.path().join("table.csv");
    changed(&other, &table, |row| row);
    let text = std::fs::read_to_string(&table).unwrap();
    let rows: Vec<Vec<&str>> = (text.lines().skip(1))
        .map(|line| line.split(',').collect())
        .collect();
    // Rows of 2 ms, and of 10 ms between which the pulses come.
    let logged = |first: usize, every: usize| {
        let mut log = "t_s,command,position_deg\n".to_owned();
        for (k, row) in rows.iter().enumerate().skip(first).step_by(every) {
            // The next frame's command from a row on that another frame has elsewhere.
            let frame = k / 10;
            let written = k % 10 >= (frame * 7919) % 10;
            let from = if written { 10 * (frame + 1) } else { k };
            let command = rows.get(from).unwrap_or(row)[1];
            log += &format!("{},{command},{}\n", row[0], row[2]);
        }
        std::fs::write(&table, log).unwrap();
    };
    let error = |more: &[&str]| {
        let named = "--input command --output position_deg --time t_s --json".split(' ');
        let args = ["validate", "-q", arg(&model), arg(&table)];
        let args: Vec<&str> = args
            .into_iter()
            .chain(named)
            .chain(more.iter().copied())
            .collect();
        let found: serde_json::Value = serde_json::from_str(&run(&args)).unwrap();
        let rmse = found["servo_model"]["rmse"].as_f64().unwrap();
        (rmse, found["pulses"]["first_pulse_s"][0].as_f64())
    };
    logged(0, 1);
    let (waiting, none) = error(&[]);
    let (held, pulse_s) = error(&["--frame-ms", "20"]);
    assert_eq!(none, None);
    // The sensor's noise is 0.05 deg; a frame is known to a part of a row.
    assert!(held < 0.07 && waiting > 4.0 * held, "{waiting} {held}");
    let off = pulse_s.unwrap().min(0.02 - pulse_s.unwrap());
    assert!(off < 0.002, "{pulse_s:?}");
    // The rows begin 6 ms after a pulse.
    logged(3, 5);
    let (held, pulse_s) = error(&["--frame-ms", "20"]);
    assert!(held < 0.07, "{held}");
    assert!((pulse_s.unwrap() - 0.014).abs() < 0.002, "{pulse_s:?}");
}

#[test]
fn commands_that_stand_at_their_pulses_are_said_to_where_a_frame_is_stated() {
    let dir = tempfile::tempdir().unwrap();
    let files = model_and_other(dir.path());
    let said = said_with(dir.path(), &files, |row| row, &["--frame-ms", "20"]);
    assert!(
        said.contains("what holds is a validation without --frame-ms"),
        "{said}"
    );
}

#[test]
fn milliseconds_under_a_name_in_seconds_come_before_all_that_follows_from_them() {
    let dir = tempfile::tempdir().unwrap();
    let files = model_and_other(dir.path());
    let said = said(dir.path(), &files, |[t, u, y]| [1e3 * t, u, y]);
    assert!(
        said.contains("state the period in seconds: --period 0.002 if it is 2 ms."),
        "{said}"
    );
    for consequence in ["Nothing needs to be done", "does not hold here"] {
        assert!(!said.contains(consequence), "{said}");
    }
}

#[test]
fn commands_in_another_unit_show_by_their_range() {
    let dir = tempfile::tempdir().unwrap();
    let files = model_and_other(dir.path());
    let said = said(dir.path(), &files, |[t, u, y]| [t, 57.29578 * u, y]);
    assert!(
        said.contains(
            "The command of the model is in deg and went from -8.000 to 8.000; that of this recording has no unit and goes from -458.4 to 458.4."
        ),
        "{said}"
    );
    assert!(!said.contains("the motion is not"), "{said}");
    assert_eq!(said.matches("worse than its mean does").count(), 1);
}

#[test]
fn a_position_that_was_written_from_another_start_is_later_than_any_servo() {
    let dir = tempfile::tempdir().unwrap();
    let [recording, table] = ["a.csv", "late.csv"].map(|name| dir.path().join(name));
    let simulate = ["simulate", "-q", "--servo", "linear", "-o", arg(&recording)];
    let stairs = ["--reference", "stairs", "--length", "20", "--hold", "1.5"];
    run(&[&simulate[..], &stairs].concat());
    let samples_late = 200;
    changed(&recording, &table, |row| row);
    let text = std::fs::read_to_string(&table).unwrap();
    let rows: Vec<Vec<&str>> = text
        .lines()
        .skip(1)
        .map(|l| l.split(',').collect())
        .collect();
    let late = |k: usize| rows[k.saturating_sub(samples_late)][2];
    let moved: String = (0..rows.len())
        .map(|k| format!("{},{},{}\n", rows[k][0], rows[k][1], late(k)))
        .collect();
    for (name, table_text, is_late) in [
        ("on_time", text.clone(), false),
        ("late", format!("t_s,command,position_deg\n{moved}"), true),
    ] {
        let table = dir.path().join(format!("{name}.csv"));
        let out = dir.path().join(format!("{name}.json"));
        std::fs::write(&table, table_text).unwrap();
        let named = "--input command --output position_deg --time t_s".split(' ');
        let args = ["identify", "-q", arg(&table), "-o", arg(&out)];
        let args: Vec<&str> = args.into_iter().chain(named).collect();
        let said = run(&args).split_whitespace().collect::<Vec<_>>().join(" ");
        assert_eq!(
            said.contains("and no servo waits as long. Make sure that the columns of command and position begin at the same moment"),
            is_late,
            "{said}"
        );
        let checks = json(&out)["advice"].to_string();
        assert_eq!(checks.contains("\"duration\""), is_late, "{checks}");
    }
}
