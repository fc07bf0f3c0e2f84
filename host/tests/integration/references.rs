//! Every reference from capture to validation, in this process.

use crate::support::{arg, json, refusal, run};
use servoid::data::dataset::{DatasetOptions, load};
use servoid::data::recording::{Completeness, Recording};
use servoid::instrument::rig::roll_frames;
use servoid_protocol::PulseTrain;
use servoid_protocol::timing::SAMPLES_PER_FRAME;
use servoid_simulator::linear::LinearParameters;
use std::path::{Path, PathBuf};

/// A whole recording, what its header says of the reference, and the options that it came from.
fn captured(file: &Path, port: &str, options: &[&str]) -> Recording {
    run(&[
        &["capture", "--port", port, "-o", arg(file), "--quiet"],
        options,
    ]
    .concat());
    let recording = Recording::read(file).unwrap();
    assert_eq!(recording.completeness, Completeness::Complete);
    recording
}

/// The exact linear servo is in the band, the model predicts another run, and the rest around the
/// reference is left out.
fn goes_all_the_way(options: &[&str], expected: &[(&str, i64)]) {
    let dir = tempfile::tempdir().unwrap();
    let [first, second, model] =
        ["first.csv", "second.csv", "model.json"].map(|name| dir.path().join(name));
    let recording = captured(&first, "sim:linear?seed=1", options);
    captured(&second, "sim:linear?seed=2", options);
    let header = recording.header.reference.as_ref().unwrap();
    assert_eq!(
        header["kind"].as_str(),
        Some(options[1])
            .filter(|k| !k.contains('.'))
            .or(Some("steps"))
    );
    for (key, value) in expected {
        assert_eq!(header[*key].as_integer(), Some(*value), "{key}");
    }
    let frames = recording.header.reference_frames as usize;
    let rest = 2 * usize::from(roll_frames(PulseTrain::USUAL)) * SAMPLES_PER_FRAME;
    assert_eq!(recording.rows.len(), frames * SAMPLES_PER_FRAME + rest);
    let used = load(std::slice::from_ref(&first), &DatasetOptions::default()).unwrap();
    assert_eq!(used.record.samples(), frames * SAMPLES_PER_FRAME);

    // Long enough for the linear servo, and the same for all: 0.28 s.
    let settling = ["--settling", "141"];
    run(&[
        &["identify", arg(&first), "-o", arg(&model), "--quiet"],
        &settling[..],
    ]
    .concat());
    let found = json(&model);
    let truth = LinearParameters::default();
    let numbers = |pointer: &str| -> Vec<f64> {
        let list = found.pointer(pointer).unwrap().as_array().unwrap();
        list.iter().map(|number| number.as_f64().unwrap()).collect()
    };
    let (lower, upper) = (
        numbers("/step/bounds/simultaneous/lower"),
        numbers("/step/bounds/simultaneous/upper"),
    );
    let phase = found["sample_phase_s"].as_f64().unwrap();
    for (m, (lower, upper)) in lower.iter().zip(&upper).enumerate() {
        let exact = match m {
            140 => truth.gain,
            _ => truth.step_response(0.002 * m as f64 + phase),
        };
        assert!(
            (*lower..=*upper).contains(&exact),
            "{options:?}, sample {m}: {lower}..{upper}, {exact}"
        );
    }
    let validated = run(&["validate", arg(&model), arg(&second), "--json"]);
    let validated: serde_json::Value = serde_json::from_str(&validated).unwrap();
    let fit = validated["fit_percent"].as_f64().unwrap();
    assert!(fit > 95.0, "{options:?}: {fit} %");
}

#[test]
fn stairs() {
    goes_all_the_way(
        &["--reference", "stairs", "--levels", "4", "--hold", "0.4"],
        &[
            ("amplitude_us", 50),
            ("levels", 4),
            ("hold_frames", 20),
            ("cycles", 2),
        ],
    );
}

#[test]
fn prbs() {
    goes_all_the_way(
        &[
            "--reference",
            "prbs",
            "--amplitude",
            "4",
            "--prbs-seed",
            "44",
        ],
        &[
            ("amplitude_us", 40),
            ("register", 6),
            ("seed", 44),
            ("chip_frames", 8),
            ("chips", 63),
        ],
    );
}

#[test]
fn sweep() {
    goes_all_the_way(
        &[
            "--reference",
            "sweep",
            "--frequencies",
            "0.1:20",
            "--length",
            "20",
        ],
        &[
            ("first_millihertz", 100),
            ("last_millihertz", 20_000),
            ("frames", 1000),
        ],
    );
}

#[test]
fn multisine() {
    goes_all_the_way(
        &[
            "--reference",
            "multisine",
            "--frequencies",
            "0.2:24",
            "--length",
            "20",
        ],
        &[
            ("period_frames", 500),
            ("first", 2),
            ("spacing", 2),
            ("tones", 120),
            ("periods", 2),
        ],
    );
}

#[test]
fn a_table_of_steps() {
    let dir = tempfile::tempdir().unwrap();
    let table = dir.path().join("steps.csv");
    std::fs::write(&table, "angle_deg,hold_s\n5,0.5\n-5,0.3\n2,0.36\n-3,0.42\n").unwrap();
    goes_all_the_way(
        &["--reference", arg(&table), "--length", "10"],
        &[("repeats", 6)],
    );
}

/// Many levels show what the two levels of the paper's staircase cannot show.
#[test]
fn stairs_show_limits_that_the_staircase_cannot() {
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("stairs.csv");
    captured(&file, "sim:linear?seed=3", &["--reference", "stairs"]);
    let found = run(&["identify", arg(&file), "--limits", "--json", "--quiet"]);
    let found: serde_json::Value = serde_json::from_str(&found).unwrap();
    let limits = &found["limits"];
    for rate in ["rate_up", "rate_down"] {
        assert_eq!(
            limits[rate]["verdict"], "proportional",
            "{}",
            limits[rate]["statement"]
        );
    }
    assert_eq!(limits["hysteresis"]["found"], false);
    assert!(
        limits["ends"]
            .as_array()
            .unwrap()
            .iter()
            .all(|end| end["softens"] == false)
    );
    assert_eq!(found["directions"]["asymmetric"], false);
}

#[test]
fn several_runs_are_several_recordings_with_noise_of_their_own() {
    let dir = tempfile::tempdir().unwrap();
    let out = dir.path().join("rec.csv");
    let args = [
        "capture",
        "--port",
        "sim:linear",
        "--reference",
        "prbs",
        "--length",
        "4",
        "-o",
        arg(&out),
    ];
    let result = run(&[&args[..], &["--repeat", "3", "--json"]].concat());
    let result: serde_json::Value = serde_json::from_str(&result).unwrap();
    assert_eq!(result["runs"].as_array().unwrap().len(), 3);
    let files: Vec<PathBuf> = (1..=3)
        .map(|run| dir.path().join(format!("rec-{run}.csv")))
        .collect();
    let runs: Vec<Recording> = files
        .iter()
        .map(|file| Recording::read(file).unwrap())
        .collect();
    assert!(!out.exists());
    let pulses = |run: &Recording| run.rows.iter().map(|row| row.pulse).collect::<Vec<_>>();
    for run in &runs {
        assert_eq!(run.completeness, Completeness::Complete);
        assert_eq!(pulses(run), pulses(&runs[0]));
    }
    assert_ne!(runs[0].rows, runs[1].rows);
    let data = load(&files, &DatasetOptions::default()).unwrap();
    assert_eq!(data.record.runs().len(), 3);
    // None is replaced, and none is made where one is in the way.
    std::fs::remove_file(&files[0]).unwrap();
    assert!(refusal(&[&args[..], &["--repeat", "3"]].concat()).contains("rec-2.csv"));
    assert!(!files[0].exists());
}

/// The run in which the sensor breaks is labelled, and the runs before it are whole.
#[test]
fn the_first_run_that_fails_is_the_last() {
    let dir = tempfile::tempdir().unwrap();
    let out = dir.path().join("rec.csv");
    // A run takes 8.8 s.
    let said = refusal(&[
        "capture",
        "--port",
        "sim:bench?fault=open@12",
        "--repeat",
        "3",
        "-o",
        arg(&out),
    ]);
    assert!(
        said.contains("rec-2.csv") && said.contains("1 complete"),
        "{said}"
    );
    let completeness = |name: &str| {
        Recording::read(&dir.path().join(name))
            .unwrap()
            .completeness
    };
    assert_eq!(completeness("rec-1.csv"), Completeness::Complete);
    assert!(matches!(
        completeness("rec-2.csv"),
        Completeness::Partial(_)
    ));
    assert!(!dir.path().join("rec-3.csv").exists());
}

#[test]
fn what_does_not_go_together_is_wrong_usage() {
    let dir = tempfile::tempdir().unwrap();
    let out = dir.path().join("x.csv");
    for (options, advice) in [
        (&["--reference", "sine"][..], "multisine"),
        (&["--reference", "sweep", "--prbs-seed", "5"], "prbs"),
        (&["--reference", "stairs", "--levels", "40"], "2 to 16"),
        (&["--reference", "missing.csv"], "missing.csv"),
        (&["--reference", "sweep", "--frequencies", "1:99"], "25 Hz"),
        (&["--repeat", "0"], "--repeat"),
        // Beyond the limits of the rig, as the board says.
        (&["--reference", "prbs", "--amplitude", "60"], "limits"),
    ] {
        let said = refusal(
            &[
                &["capture", "--port", "sim:bench", "-o", arg(&out)],
                options,
            ]
            .concat(),
        );
        assert!(said.contains(advice), "{options:?}: {said}");
        assert!(!out.exists());
    }
}
