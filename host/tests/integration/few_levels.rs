//! A servo of limited speed between two levels: what is said of it, and what is not.

use crate::support::{arg, json, run};
use servoid_test_support::plants::{normal, random};
use std::path::{Path, PathBuf};

/// The most that it moves in a second.
const TOP_SPEED: f64 = 280.0;

/// Time between rows \[s\].
const PERIOD_S: f64 = 0.01;

/// Random changes between -60 and 60, one in 0.3 s at the most, and the motion of a servo whose gain is one.
fn telegraph(folder: &Path) -> PathBuf {
    let mut random = random(8);
    let (mut command, mut at) = (0.0, 0.0);
    let mut text = "t_s,u,y\n".to_owned();
    for k in 0..3000 {
        if k % 30 == 0 {
            command = 60_f64.copysign(normal(&mut random));
        }
        let output = at + 0.2 * normal(&mut random);
        text += &format!("{:.2},{command},{output:.4}\n", f64::from(k) * PERIOD_S);
        at += (0.3 * (command - at)).clamp(-TOP_SPEED * PERIOD_S, TOP_SPEED * PERIOD_S);
    }
    let file = folder.join("telegraph.csv");
    std::fs::write(&file, text).unwrap();
    file
}

#[test]
fn figures_of_the_linear_model_are_not_said_to_be_those_of_the_servo() {
    let folder = tempfile::tempdir().unwrap();
    let (table, model) = (telegraph(folder.path()), folder.path().join("servo.json"));
    let columns = ["--input", "u", "--output", "y"];
    let text = run(&[&["identify", arg(&table), "-o", arg(&model)], &columns[..]].concat());
    let words: Vec<&str> = text.split_whitespace().collect();
    let text = words.join(" ");
    let document = json(&model);
    assert_eq!(document["withdrawn"]["reason"], "errors_not_noise");
    assert!(
        !text.contains("the servo passes") && !text.contains("the servo ends"),
        "{text}"
    );
    assert!(!text.contains("does not excite"), "{text}");
    let servo = &document["servo_model"];
    assert_eq!(servo["withdrawn"]["reason"], "few_levels");
    assert!(text.contains("fewer than three levels"), "{text}");
    // Noise alone makes the measured speed larger than the limit, and what was surely reached is not.
    let [reached, noise] = ["upwards", "noise"].map(|of| servo["reached"][of].as_f64().unwrap());
    assert!(
        reached + noise > TOP_SPEED,
        "the case no longer has what it is for"
    );
    assert!(reached < TOP_SPEED, "{reached}");
    assert!(
        text.starts_with("This servo moves as if limited to 280 units/s"),
        "{text}"
    );
    let file = folder.path().join("servo.py");
    run(&[
        "export",
        arg(&model),
        "--to",
        "python",
        "-o",
        arg(&file),
        "-q",
    ]);
    let text = std::fs::read_to_string(file).unwrap();
    let (_, called) = text.split_once("def simulate(").unwrap();
    assert!(called.contains("This response is a picture of the recording"));
}
