//! Captures through the byte link, on simulated servos.

use crate::support::{arg, refusal, run, servoid};
use servoid::data::DegreeScale;
use servoid::data::dataset::{DatasetOptions, load};
use servoid::data::recording::{Completeness, Recording};
use servoid_protocol::PulseTrain;
use servoid_protocol::reference::Staircase;
use servoid_protocol::timing::SAMPLES_PER_FRAME;

#[test]
fn a_capture_is_whole_and_has_the_applied_pulse_beside_each_sample() {
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("bench.csv");
    run(&["capture", "--port", "sim:bench", "-o", arg(&file)]);
    let recording = Recording::read(&file).unwrap();
    assert_eq!(recording.completeness, Completeness::Complete);
    let roll =
        usize::from(servoid::instrument::rig::roll_frames(PulseTrain::USUAL)) * SAMPLES_PER_FRAME;
    let count = recording.rows.len();
    assert_eq!(count, roll + 3600 + roll);
    assert!(
        recording
            .rows
            .iter()
            .map(|row| row.sample)
            .eq(0..count as u64),
        "no gap"
    );
    let expected = (0..count).map(|sample| {
        let in_reference = sample
            .checked_sub(roll)
            .map(|s| (s / SAMPLES_PER_FRAME) as u32);
        let offset = in_reference.and_then(|frame| Staircase::PAPER.offset_us(frame));
        f64::from(offset.unwrap_or(0)) / 10.0
    });
    let scale = DegreeScale::of_recording(&recording.header);
    let (reference, position) = scale.columns(&recording.rows);
    assert!(reference.into_iter().eq(expected));
    // The servo follows: on the last tenth of the first hold it is within a degree of it.
    let plateau = &position[roll + 360..roll + 400];
    assert!(plateau.iter().all(|y| (y - 5.0).abs() < 1.0), "{plateau:?}");
}

/// The run is whole, and what is in it is no motion: the sensor works, and the servo stands at a stop.
#[test]
fn a_servo_that_hardly_moves_is_named_once_its_recording_is_kept() {
    let dir = tempfile::tempdir().unwrap();
    for (port, moves) in [
        ("sim:bench?stops-deg=-0.01:0.01", false),
        ("sim:linear?gain=0.05", false),
        ("sim:linear?gain=0.5", true),
        ("sim:aircraft", true),
    ] {
        let file = dir.path().join("rec.csv");
        let said = run(&["capture", "--force", "--port", port, "-o", arg(&file)]);
        let (saved, warning) = (said.find("complete, 4400"), said.find("hardly moved"));
        assert_eq!(warning.is_none(), moves, "{port}: {said}");
        assert!(moves || saved < warning, "{said}");
    }
}

/// Fast steps of little power are followed by little of each, and still seen.
#[test]
fn a_servo_that_follows_fast_steps_has_moved() {
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("rec.csv");
    for fast in [["prbs", "--hold", "0.04"], ["multisine", "--length", "4"]] {
        let reference = [&["--reference"], &fast[..]].concat();
        let capture = [
            "capture",
            "--force",
            "--port",
            "sim:bench",
            "-o",
            arg(&file),
        ];
        let said = run(&[&capture[..], &reference].concat());
        assert!(!said.contains("hardly moved"), "{fast:?}: {said}");
    }
}

#[test]
fn equal_seeds_give_equal_rows_and_others_do_not() {
    let dir = tempfile::tempdir().unwrap();
    let rows = |name: &str, seed: &str| {
        let file = dir.path().join(name);
        run(&[
            "simulate",
            "--servo",
            "aircraft",
            "--seed",
            seed,
            "-o",
            arg(&file),
        ]);
        Recording::read(&file).unwrap().rows
    };
    let first = rows("a.csv", "5");
    assert_eq!(first, rows("b.csv", "5"));
    assert_ne!(first, rows("c.csv", "6"));
}

#[test]
fn an_existing_file_is_kept_unless_forced() {
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("x.csv");
    std::fs::write(&file, "precious").unwrap();
    let args = ["capture", "--port", "sim:bench", "-o", arg(&file)];
    assert!(refusal(&args).contains("--force"));
    assert_eq!(std::fs::read_to_string(&file).unwrap(), "precious");
    run(&[&args[..], &["--force"]].concat());
    assert_eq!(
        Recording::read(&file).unwrap().completeness,
        Completeness::Complete
    );
}

#[test]
fn a_sensor_that_breaks_ends_the_run_and_keeps_the_rows() {
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("x.csv");
    let args = [
        "capture",
        "--port",
        "sim:bench?fault=open@3",
        "-o",
        arg(&file),
    ];
    let said = refusal(&args);
    assert!(
        said.contains("partial") && said.contains("sensor"),
        "{said}"
    );
    let recording = Recording::read(&file).unwrap();
    let Completeness::Partial(reason) = &recording.completeness else {
        panic!("it is partial")
    };
    assert!(reason.contains("sensor"), "{reason}");
    assert!(recording.rows.len() > 1000, "{}", recording.rows.len());
    // What the broken sensor said is not taken for motion.
    let data = load(&[file], &DatasetOptions::default()).unwrap();
    assert!(data.record.missing() >= 5, "{:?}", data.about.remarks);
    assert!(
        data.record.runs()[0]
            .output()
            .iter()
            .all(|y| y.is_nan() || y.abs() <= 20.0)
    );
}

/// Its readings are within the healthy range, and they never change.
#[test]
fn a_sensor_that_freezes_is_found_in_the_run_in_its_file_and_by_identify() {
    let dir = tempfile::tempdir().unwrap();
    let (file, model) = (dir.path().join("x.csv"), dir.path().join("x.json"));
    let port = "sim:bench?fault=frozen@3-5.6";
    let capture = ["capture", "--port", port, "--plain", "-o", arg(&file)];
    let output = servoid(&capture).output().unwrap();
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(3), "{said}");
    assert!(said.contains("THE SENSOR'S READING STANDS STILL"), "{said}");
    assert!(said.contains("stood still at"), "{said}");
    let recording = Recording::read(&file).unwrap();
    let Completeness::Partial(reason) = &recording.completeness else {
        panic!("it is partial")
    };
    assert!(reason.contains("for 2.6 s"), "{reason}");
    assert_eq!(recording.rows.len(), 4_400);
    // What it said is not taken for motion either.
    let data = load(std::slice::from_ref(&file), &DatasetOptions::default()).unwrap();
    assert!(
        (1_250..1_350).contains(&data.record.missing()),
        "{:?}",
        data.about.remarks
    );
    let output = servoid(&["identify", arg(&file), "-o", arg(&model)])
        .output()
        .unwrap();
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(said.contains("stood still at"), "{said}");
    let model = std::fs::read_to_string(&model).unwrap();
    assert!(model.contains("\"frozen_sensor\""), "{model}");
}

#[test]
fn remarks_with_line_ends_and_quotes_survive() {
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("x.csv");
    let notes = "a\nb \"q\" # x \\ \u{7f}\t ü";
    let args = [
        "capture",
        "--port",
        "sim:linear",
        "--notes",
        notes,
        "-o",
        arg(&file),
    ];
    run(&args);
    let recording = Recording::read(&file).unwrap();
    assert_eq!(recording.completeness, Completeness::Complete);
    assert_eq!(recording.header.notes, notes);
}

/// Ctrl-C, what a system sends before it shuts down, and a terminal that is closed.
#[cfg(unix)]
#[test]
fn a_signal_to_end_closes_the_file_and_keeps_the_data() {
    for signal in ["-INT", "-TERM", "-HUP"] {
        end_by(signal);
    }
}

#[cfg(unix)]
fn end_by(signal: &str) {
    use std::process::{Command, Stdio};
    use std::time::{Duration, Instant};

    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("x.csv");
    let mut child = Command::new(env!("CARGO_BIN_EXE_servoid"))
        .args(["capture", "--port", "sim:bench?realtime", "-o", arg(&file)])
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let started = Instant::now();
    // Wait until rows are on the disk, then interrupt.
    while std::fs::metadata(&file).map_or(0, |m| m.len()) < 4000 {
        assert!(started.elapsed() < Duration::from_secs(60), "no rows came");
        std::thread::sleep(Duration::from_millis(20));
    }
    let pid = child.id().to_string();
    assert!(
        Command::new("kill")
            .args([signal, &pid])
            .status()
            .unwrap()
            .success()
    );
    let status = child.wait().unwrap();
    assert_eq!(status.code(), Some(3), "{signal}: {status}");
    let recording = Recording::read(&file).unwrap();
    let Completeness::Partial(reason) = &recording.completeness else {
        panic!("it is partial")
    };
    assert!(reason.contains("stopped"), "{reason}");
    assert!(
        recording
            .rows
            .iter()
            .map(|row| row.sample)
            .eq(0..recording.rows.len() as u64)
    );
}
