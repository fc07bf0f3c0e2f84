//! Servos that do not go as far as they are commanded: whether the stop is named, or the scale.

use crate::support::{arg, json, run};
use std::path::Path;

/// What is said of a staircase between -`amplitude` and `amplitude` degrees of the simulated servo, with its document.
fn identified(dir: &Path, servo: &str, amplitude: &str) -> (String, serde_json::Value) {
    let [rig, recording, model] = ["rig.toml", "x.csv", "x.json"].map(|name| dir.join(name));
    let of_rig = [
        "init",
        "--yes",
        "--force",
        "--travel=-50:50",
        "-o",
        arg(&rig),
    ];
    run(&[&of_rig[..], &["--port", servo]].concat());
    let captured = [
        "capture",
        "-q",
        "--force",
        "--rig",
        arg(&rig),
        "-o",
        arg(&recording),
    ];
    run(&[&captured[..], &["--amplitude", amplitude]].concat());
    let text = run(&[
        "identify",
        "-q",
        "--force",
        arg(&recording),
        "-o",
        arg(&model),
    ]);
    (
        text.split_whitespace().collect::<Vec<_>>().join(" "),
        json(&model),
    )
}

/// By the scale of another kind of sensor, the gain would be 1.
#[test]
fn a_staircase_between_two_stops_names_them_and_no_sensor() {
    let dir = tempfile::tempdir().unwrap();
    let (text, model) = identified(dir.path(), "sim:bench?stops-deg=-10:15&seed=4", "30");
    let stops = "The servo runs into a stop at -10.0 deg under a command of -30.0, and at 15.0 deg";
    let first = text.find(stops).unwrap();
    let table = text.find("NO BOUNDS CAN BE GIVEN").unwrap();
    assert!(text.find("No bounds").unwrap() < first && first < table);
    assert!(!text.contains("another kind"), "{text}");
    assert!(!text.contains("with 99 % confidence"), "{text}");
    assert_eq!(model["withdrawn"]["reason"], "travel_end");
    assert_eq!(model["stops"].as_array().unwrap().len(), 2);
    let page = dir.path().join("x.html");
    let recording = dir.path().join("x.csv");
    run(&["report", "-q", arg(&recording), "-o", arg(&page)]);
    let page = std::fs::read_to_string(page).unwrap();
    let verdict = page.split("id=\"verdict\">").nth(1).unwrap();
    assert!(
        verdict.starts_with("No bounds can be given. The servo runs into a stop"),
        "{}",
        &verdict[..200]
    );
}

/// The scale alone is wrong here: the servo is free, and keeps its level.
#[test]
fn a_wrong_scale_is_no_stop() {
    let dir = tempfile::tempdir().unwrap();
    for servo in [
        "sim:bench?sensor-gain=0.6&seed=1",
        "sim:linear?gain=0.6&seed=1",
    ] {
        let (text, model) = identified(dir.path(), servo, "10");
        assert!(text.contains("The servo ends at 0.6"), "{text}");
        assert!(
            text.contains("a stop is unlikely") && !text.contains("runs into"),
            "{text}"
        );
        assert!(model["withdrawn"].is_null(), "{text}");
    }
}

/// It rests 0.04 degrees beyond its command, within every dead band. A calibration finds the same again.
#[test]
fn what_a_dead_band_does_is_no_wrong_scale() {
    let dir = tempfile::tempdir().unwrap();
    let rig = dir.path().join("rig.toml");
    run(&[
        "init",
        "--yes",
        "--travel=-30:30",
        "--port",
        "sim:bench?seed=2",
        "-o",
        arg(&rig),
    ]);
    let angles = "--angles=-24,-12,0,12,24";
    run(&[
        "calibrate",
        "-q",
        "--rig",
        arg(&rig),
        angles,
        "--update",
        "--yes",
    ]);
    let recording = dir.path().join("x.csv");
    run(&["capture", "-q", "--rig", arg(&rig), "-o", arg(&recording)]);
    let text = run(&["identify", "-q", arg(&recording)]);
    assert!(text.contains("After a step"), "{text}");
    assert!(!text.contains("The servo ends at"), "{text}");
}

/// Sines that hardly change their frequency, in frames of 20 ms: within some holds the output turns round, and seems to rest there. The simulated servo has no stops.
#[test]
fn a_sine_whose_output_turns_round_shows_no_stop() {
    let dir = tempfile::tempdir().unwrap();
    for (number, (frequencies, amplitude)) in [("4:4.05", "4.97"), ("5:5.05", "4.97")]
        .into_iter()
        .enumerate()
    {
        let recording = dir.path().join(format!("{number}.csv"));
        let reference = ["--reference", "sweep", "--length", "10"];
        let sweep = ["--frequencies", frequencies, "--amplitude", amplitude];
        let simulate = ["simulate", "-q", "--servo", "bench", "-o", arg(&recording)];
        run(&[&simulate[..], &reference, &sweep].concat());
        let said = run(&["identify", "-q", arg(&recording)]);
        for stop in ["stops at", "a stop at"] {
            assert!(!said.contains(stop), "{frequencies}: {said}");
        }
    }
}
