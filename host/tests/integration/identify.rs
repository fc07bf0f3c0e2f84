//! Identification from files, on real recordings too.

use crate::support::{arg, data, json, run};
use std::path::{Path, PathBuf};

/// The data rows `range` of a file, with its header row.
fn part(of: &Path, range: std::ops::Range<usize>, into: &Path) -> PathBuf {
    let text = std::fs::read_to_string(of).unwrap();
    let (header, rows) = text.split_once('\n').unwrap();
    let rows: Vec<&str> = rows.lines().skip(range.start).take(range.len()).collect();
    let path = into.join(format!("{}-{}.csv", range.start, range.end));
    std::fs::write(&path, format!("{header}\n{}\n", rows.join("\n"))).unwrap();
    path
}

#[test]
fn half_of_a_real_recording_predicts_the_other_half() {
    let dir = tempfile::tempdir().unwrap();
    let all = data("dcmotor_speed_prbs.csv");
    let first = part(&all, 0..2046, dir.path());
    let second = part(&all, 2046..4093, dir.path());
    let model = dir.path().join("model.json");
    let columns = ["--input", "u", "--output", "y", "--period", "0.02"];
    let identify = [
        "identify",
        arg(&first),
        "--settling",
        "50",
        "-o",
        arg(&model),
    ];
    run(&[&identify[..], &columns].concat());
    let validate = ["validate", arg(&model), arg(&second), "--json"];
    let result: serde_json::Value =
        serde_json::from_str(&run(&[&validate[..], &columns].concat())).unwrap();
    // Plain FIR least squares of the same length gives 96.4 % there.
    let fit = result["fit_percent"].as_f64().unwrap();
    assert!(fit >= 95.0, "{fit}");
}

#[test]
fn the_model_has_every_field_and_finite_numbers() {
    let dir = tempfile::tempdir().unwrap();
    let (file, model) = (dir.path().join("x.csv"), dir.path().join("x.json"));
    run(&["simulate", "--servo", "linear", "-o", arg(&file)]);
    let plots = dir.path().join("plots");
    run(&[
        "identify",
        arg(&file),
        "-o",
        arg(&model),
        "--plots",
        arg(&plots),
    ]);
    let model = json(&model);
    assert_eq!(model["schema"], 1);
    assert_eq!(model["sample_period_s"], 0.002);
    let settling = model["structure"]["settling_samples"].as_u64().unwrap() as usize;
    let frequencies = model["structure"]["frequencies"].as_u64().unwrap() as usize;
    let length = |pointer: &str| model.pointer(pointer).unwrap().as_array().unwrap().len();
    assert_eq!(length("/theta"), frequencies);
    assert_eq!(length("/covariance"), frequencies);
    assert_eq!(length("/covariance/0"), frequencies);
    for field in [
        "time_s",
        "value",
        "sd",
        "pointwise/lower",
        "pointwise/upper",
        "simultaneous/lower",
        "simultaneous/upper",
    ] {
        assert_eq!(length(&format!("/step/{field}")), settling, "{field}");
    }
    let points = length("/frequency/omega_rad_s");
    for field in [
        "re",
        "im",
        "magnitude_db",
        "phase_deg",
        "magnitude_db_lower",
        "phase_deg_upper",
    ] {
        assert_eq!(length(&format!("/frequency/{field}")), points, "{field}");
    }
    for pointer in [
        "/metrics/dc_gain/value",
        "/metrics/delay_s/value",
        "/fit/simulation_percent",
        "/fit/rmse",
        "/residuals/whiteness_p",
        "/noise/sigma",
    ] {
        assert!(
            model
                .pointer(pointer)
                .is_some_and(serde_json::Value::is_number),
            "{pointer}"
        );
    }
    // A lag: the phase falls with the frequency.
    let phase = model["frequency"]["phase_deg"].as_array().unwrap();
    assert!(phase[points / 3].as_f64().unwrap() < 0.0);
    assert_eq!(std::fs::read_dir(&plots).unwrap().count(), 4);
}

#[test]
fn several_files_and_a_run_column_are_separate_runs() {
    let dir = tempfile::tempdir().unwrap();
    let files: Vec<PathBuf> = (1..=2)
        .map(|seed| {
            let file = dir.path().join(format!("{seed}.csv"));
            run(&[
                "simulate",
                "--servo",
                "linear",
                "--seed",
                &seed.to_string(),
                "-o",
                arg(&file),
            ]);
            file
        })
        .collect();
    let used = |args: &[&str]| {
        let model: serde_json::Value =
            serde_json::from_str(&run(&[args, &["--json"]].concat())).unwrap();
        model["fit"]["samples_used"].as_u64().unwrap()
    };
    let fixed = ["--settling", "151", "--noise-order", "2"];
    let one = used(&[&["identify", arg(&files[0])], &fixed[..]].concat());
    let two = used(&[&["identify", arg(&files[0]), arg(&files[1])], &fixed[..]].concat());
    assert_eq!(two, 2 * one, "each run loses its own first rows");

    let servo = data("miuzei_rc_servo_large.csv");
    let columns = [
        "identify",
        arg(&servo),
        "--input",
        "u",
        "--output",
        "y",
        "--run",
        "run",
        "--period",
        "0.02",
        "--at-rest",
        "0",
        "--settling",
        "41",
    ];
    assert_eq!(
        used(&columns),
        4950,
        "at rest before each run: no row is lost"
    );
}

#[test]
fn every_real_recording_gives_a_model() {
    for (file, columns) in [
        ("dcmotor_position_stairs.csv", &["--at-rest", "0"][..]),
        ("dcmotor_speed_prbs.csv", &[]),
        (
            "miuzei_rc_servo_large.csv",
            &["--run", "run", "--at-rest", "0"],
        ),
        (
            "bam_xl330_pendulum.csv",
            &["--run", "run", "--period", "0.005"],
        ),
    ] {
        let path = data(file);
        let args = ["identify", arg(&path), "--input", "u", "--output", "y"];
        let period: &[&str] = if file.starts_with("bam") {
            &[]
        } else {
            &["--period", "0.02"]
        };
        let text = run(&[&args[..], columns, period].concat());
        assert!(
            text.contains("structure") && text.contains("DC gain"),
            "{file}: {text}"
        );
    }
}
