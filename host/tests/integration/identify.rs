//! Identification from files, on real recordings too.

use crate::support::{SHORT_STAIRS, arg, data, json, run};
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
    assert_eq!(model["schema"], 2);
    assert!(model["withdrawn"].is_null());
    assert_eq!(model["sample_period_s"], 0.002);
    let settling = model["structure"]["settling_samples"].as_u64().unwrap() as usize;
    let frequencies = model["structure"]["frequencies"].as_u64().unwrap() as usize;
    let length = |pointer: &str| model.pointer(pointer).unwrap().as_array().unwrap().len();
    assert_eq!(length("/theta"), frequencies);
    assert_eq!(length("/bounds/covariance"), frequencies);
    assert_eq!(length("/bounds/covariance/0"), frequencies);
    for field in [
        "time_s",
        "value",
        "bounds/sd",
        "bounds/pointwise/lower",
        "bounds/pointwise/upper",
        "bounds/simultaneous/lower",
        "bounds/simultaneous/upper",
    ] {
        assert_eq!(length(&format!("/step/{field}")), settling, "{field}");
    }
    let points = length("/frequency/omega_rad_s");
    for field in [
        "re",
        "im",
        "magnitude_db",
        "phase_deg",
        "bounds/magnitude_db_lower",
        "bounds/phase_deg_upper",
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

/// The rows that an identification with these arguments uses.
fn used(args: &[&str]) -> u64 {
    let model: serde_json::Value =
        serde_json::from_str(&run(&[args, &["--json"]].concat())).unwrap();
    model["fit"]["samples_used"].as_u64().unwrap()
}

#[test]
fn several_files_are_separate_runs() {
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
    let fixed = ["--settling", "151", "--noise-order", "2"];
    let one = used(&[&["identify", arg(&files[0])], &fixed[..]].concat());
    let two = used(&[&["identify", arg(&files[0]), arg(&files[1])], &fixed[..]].concat());
    assert_eq!(two, 2 * one, "each run loses its own first rows");
}

#[test]
#[ignore = "three seconds: cargo test -p servoid --test integration -- --ignored runs_that_begin_at_rest"]
fn runs_that_begin_at_rest_lose_no_row() {
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
    assert_eq!(used(&columns), 4950);
}

/// What is known of a real recording, and what servoid has to make of it.
struct RealRecording {
    file: &'static str,
    columns: &'static [&'static str],
    /// Settling times that are sensible (samples).
    settling: std::ops::RangeInclusive<u64>,
    /// Where the gain must be, with its whole interval; `None` where the errors are not noise, so that it has
    /// none.
    gain: Option<(f64, f64)>,
    /// What the simulation must explain of its own record (%).
    fit_percent: f64,
    /// Advice that must be there.
    advice: &'static [&'static str],
}

/// Of each data set what its notes say: a motor's loop that settles in about half a second without an error; the
/// speed of a motor, which follows in 0.1 s, at 164 (deg/s)/V, with a quantised and drifting reading behind it;
/// a servo that is mostly in its limit of speed; and a pendulum under references with almost no power
/// above a few Hertz.
const REAL_RECORDINGS: [RealRecording; 4] = [
    RealRecording {
        file: "dcmotor_position_stairs.csv",
        columns: &["--at-rest", "0", "--period", "0.02"],
        settling: 15..=75,
        gain: Some((0.95, 1.05)),
        fit_percent: 95.0,
        advice: &[],
    },
    RealRecording {
        file: "dcmotor_speed_prbs.csv",
        columns: &["--period", "0.02"],
        settling: 15..=255,
        gain: Some((155.0, 172.0)),
        fit_percent: 96.0,
        advice: &[],
    },
    RealRecording {
        file: "miuzei_rc_servo_large.csv",
        columns: &["--run", "run", "--at-rest", "0", "--period", "0.02"],
        settling: 15..=255,
        gain: None,
        fit_percent: 45.0,
        advice: &["model_error"],
    },
    RealRecording {
        file: "bam_xl330_pendulum.csv",
        columns: &["--run", "run", "--period", "0.005"],
        settling: 15..=400,
        gain: None,
        fit_percent: 72.0,
        advice: &["model_error", "excitation"],
    },
];

#[test]
fn real_recordings_of_motors_give_a_sensible_model() {
    require_sensible(&REAL_RECORDINGS[..2]);
}

#[test]
#[ignore = "five seconds: cargo test -p servoid --test integration -- --ignored real_recordings_of_servos"]
fn real_recordings_of_servos_give_a_sensible_model() {
    require_sensible(&REAL_RECORDINGS[2..]);
}

fn require_sensible(recordings: &[RealRecording]) {
    for real in recordings {
        let path = data(real.file);
        let args = [
            "identify",
            arg(&path),
            "--input",
            "u",
            "--output",
            "y",
            "--json",
        ];
        let text = run(&[&args[..], real.columns].concat());
        let found: serde_json::Value = serde_json::from_str(&text).unwrap();
        let number = |pointer: &str| found.pointer(pointer).and_then(serde_json::Value::as_f64);
        let settling = found["structure"]["settling_samples"].as_u64().unwrap();
        assert!(
            real.settling.contains(&settling),
            "{}: N = {settling}",
            real.file
        );
        let fit = number("/fit/simulation_percent").unwrap();
        assert!(fit >= real.fit_percent, "{}: {fit} %", real.file);
        if let Some((least, most)) = real.gain {
            let gain = ["lower", "upper"].map(|end| number(&format!("/metrics/dc_gain/{end}")));
            let [lower, upper] = gain.map(Option::unwrap);
            let inside = least <= lower && upper <= most;
            assert!(inside, "{}: gain {lower} to {upper}", real.file);
        }
        let reported = found["advice"].as_array().unwrap();
        let is_reported = |check: &str| reported.iter().any(|advice| advice["check"] == check);
        for check in real.advice {
            assert!(is_reported(check), "{}: no {check}", real.file);
        }
        assert_eq!(
            is_reported("model_error"),
            real.gain.is_none(),
            "{}",
            real.file
        );
    }
}

/// Bounds are narrowest with all frequencies, and with some left out the explanation says so.
#[test]
fn narrow_frequencies_have_wider_bounds_and_say_so() {
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("r.csv");
    run(&[
        "simulate",
        "--servo",
        "linear",
        "--seed",
        "4",
        "-o",
        arg(&file),
    ]);
    let said = run(&[
        "identify",
        arg(&file),
        "--frequencies",
        "narrow",
        "--explain",
    ]);
    let said = said.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(
        said.contains("all of them would give the narrowest band"),
        "{said}"
    );
    assert!(said.contains("which widens the bounds"), "{said}");
}

#[test]
fn a_model_is_printed_again_and_answers_for_sines_that_are_asked_for_later() {
    let dir = tempfile::tempdir().unwrap();
    let [recording, model] = ["own.csv", "own.json"].map(|name| dir.path().join(name));
    let simulate = ["simulate", "-q", "--servo", "bench", "-o", arg(&recording)];
    run(&[&simulate[..], &SHORT_STAIRS].concat());
    let sines = ["--at", "6:3,2"];
    let identify = ["identify", "-q", arg(&recording), "-o", arg(&model)];
    let of_recording = run(&[&identify[..], &sines].concat());
    let of_model = run(&[&["identify", "-q", arg(&model)], &sines[..]].concat());
    // But for the name, and the next command that a recording is followed by.
    let from_first_number = |text: &str| {
        let (_, numbers) = text.split_once("samples ").unwrap();
        numbers.split("next:").next().unwrap().trim().to_owned()
    };
    assert!(of_model.contains("gain at 6 Hz"), "{of_model}");
    assert_eq!(
        from_first_number(&of_model),
        from_first_number(&of_recording)
    );
    let document = run(&["identify", "-q", arg(&model), "--json"]);
    assert_eq!(
        serde_json::from_str::<serde_json::Value>(&document).unwrap(),
        json(&model)
    );
}
