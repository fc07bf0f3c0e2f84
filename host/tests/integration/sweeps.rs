//! A sweep of a linear servo: what of it is known in its band, and the low-order model that goes into a simulator.

use crate::support::{arg, json, run};
use serde_json::Value;
use servoid_test_support::plants::{normal, random};
use std::f64::consts::TAU;
use std::path::{Path, PathBuf};

/// Time between rows \[s\].
const PERIOD_S: f64 = 0.01;

/// A sweep of 24 s from 0.2 to 8 Hz, ±10 degrees, behind a lag of 40 ms; this share of the answer is behind one of .4 s. The table is written into `folder`.
fn sweep(folder: &Path, slow_share: f64, seed: u64) -> PathBuf {
    let mut random = random(seed);
    let (mut fast, mut slow) = (0.0, 0.0);
    let mut text = "t_s,u_deg,y_deg\n".to_owned();
    for k in 0..2400 {
        let time = f64::from(k) * PERIOD_S;
        let rate = 40f64.ln() / 24.0;
        let command = 10.0 * (TAU * 0.2 / rate * ((rate * time).exp() - 1.0)).sin();
        let output = (1.0 - slow_share) * fast + slow_share * slow + 0.05 * normal(&mut random);
        text += &format!("{time:.2},{command:.9},{output:.9}\n");
        fast += (1.0 - (-PERIOD_S / 0.04).exp()) * (command - fast);
        slow += (1.0 - (-PERIOD_S / 0.4).exp()) * (command - slow);
    }
    let file = folder.join(format!("sweep{seed}.csv"));
    std::fs::write(&file, text).unwrap();
    file
}

/// What `identify` prints of it, and the model file.
fn identified(folder: &Path, slow_share: f64) -> (String, PathBuf) {
    let (table, model) = (sweep(folder, slow_share, 5), folder.join("sweep.json"));
    let columns = ["--input", "u", "--output", "y"];
    let text = run(&[&["identify", arg(&table), "-o", arg(&model)], &columns[..]].concat());
    // A line ends anywhere in a sentence.
    let words: Vec<&str> = text.split_whitespace().collect();
    (words.join(" "), model)
}

#[test]
fn a_sweep_has_a_low_order_model_wherever_its_result_is_shown() {
    let folder = tempfile::tempdir().unwrap();
    let (text, model) = identified(folder.path(), 0.0);
    assert!(text.contains("A servo of order 1 fits from 0."), "{text}");
    assert!(text.contains("it has a gain of 1.00") || text.contains("it has a gain of 0.99"));
    let found = &json(&model)["flight_model"];
    assert_eq!(found["band_hz"].as_array().unwrap().len(), 2);
    let gain = ["lower", "upper"].map(|end| found["gain"][end].as_f64().unwrap());
    assert!(
        gain[0] < 1.0 && 1.0 < gain[1] && gain[1] - gain[0] < 0.01,
        "{gain:?}"
    );
    let page = folder.path().join("page.html");
    run(&["report", arg(&model), "-o", arg(&page)]);
    let page = std::fs::read_to_string(page).unwrap();
    assert!(page.contains("A servo of order 1 fits from 0."));
    for (target, with) in [
        ("jsbsim", "<lag_filter"),
        ("python", "of the response at 0."),
        ("c", "rests on its order"),
    ] {
        let file = folder.path().join(target);
        run(&[
            "export",
            arg(&model),
            "--to",
            target,
            "-o",
            arg(&file),
            "-q",
        ]);
        let text = std::fs::read_to_string(file).unwrap();
        assert!(text.contains(with), "{target}: {text}");
        assert!(!text.contains("approximation"), "{target}");
        let called = text.contains("This response is a picture of the recording");
        assert_eq!(called, target != "jsbsim", "{target}: {text}");
    }
}

/// Their bounds are those of the mean of the servo.
#[test]
fn three_runs_of_a_sweep_have_bounds_and_a_low_order_model_together() {
    let folder = tempfile::tempdir().unwrap();
    let runs = [5, 6, 7].map(|seed| sweep(folder.path(), 0.0, seed));
    let columns = ["--input", "u", "--output", "y"];
    let text = run(&[
        &["identify", "--no-servo-model"],
        &runs.each_ref().map(|run| arg(run))[..],
        &columns[..],
    ]
    .concat());
    let words: Vec<&str> = text.split_whitespace().collect();
    let text = words.join(" ");
    assert!(
        text.contains("Hz the frequency response is known to ±")
            && text.contains("A servo of order"),
        "{text}"
    );
    assert!(!text.contains("because the errors are not noise"), "{text}");
}

#[test]
fn a_sweep_of_a_servo_with_a_slow_end_has_an_approximation_without_a_gain() {
    let folder = tempfile::tempdir().unwrap();
    let (text, model) = identified(folder.path(), 0.03);
    assert!(!text.contains("A servo of order"), "{text}");
    assert!(text.contains("nothing shows how far it is off"), "{text}");
    let found = &json(&model)["flight_model"];
    assert!(found["gain"]["lower"].is_null() && found["bounds"].is_null());
    let file = folder.path().join("servo.py");
    let exported = run(&[
        "export",
        arg(&model),
        "--to",
        "python",
        "-o",
        arg(&file),
        "--json",
    ]);
    let exported: Value = serde_json::from_str(&exported).unwrap();
    let warnings = exported["warnings"].to_string();
    assert!(
        warnings.contains("the low-order model is an approximation: from 0."),
        "{warnings}"
    );
}
