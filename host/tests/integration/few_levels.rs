//! A servo of limited speed between two levels: what is said of it, and what is not.

use crate::support::{arg, json, run};
use servoid_test_support::plants::{normal, random};
use std::path::{Path, PathBuf};

/// The most that it moves in a second.
const TOP_SPEED: f64 = 280.0;

/// Time between rows \[s\].
const PERIOD_S: f64 = 0.01;

/// Random changes between -60 and 60, one in 0.3 s at the most, and the motion of a servo whose gain is one.
fn telegraph(folder: &Path, seed: u64, top_speed: f64) -> PathBuf {
    let mut random = random(seed);
    let (mut command, mut at) = (0.0, 0.0);
    let mut text = "t_s,u,y\n".to_owned();
    for k in 0..3000 {
        if k % 30 == 0 {
            command = 60_f64.copysign(normal(&mut random));
        }
        let output = at + 0.2 * normal(&mut random);
        text += &format!("{:.2},{command},{output:.4}\n", f64::from(k) * PERIOD_S);
        at += (0.3 * (command - at)).clamp(-top_speed * PERIOD_S, top_speed * PERIOD_S);
    }
    let file = folder.join(format!("telegraph{seed}.csv"));
    std::fs::write(&file, text).unwrap();
    file
}

#[test]
fn figures_of_the_linear_model_are_not_said_to_be_those_of_the_servo() {
    let folder = tempfile::tempdir().unwrap();
    let (table, model) = (
        telegraph(folder.path(), 8, TOP_SPEED),
        folder.path().join("servo.json"),
    );
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

/// Machines would have no intervals there: no time is spent on what shows nothing.
#[test]
fn machines_are_not_offered_for_strokes_between_two_levels() {
    let folder = tempfile::tempdir().unwrap();
    let sides = [(8, 600.0), (9, 420.0)];
    let sides = sides.map(|(seed, speed)| telegraph(folder.path(), seed, speed));
    let text = run(&[
        "compare",
        arg(&sides[0]),
        arg(&sides[1]),
        "--input",
        "u",
        "--output",
        "y",
    ]);
    assert!(text.contains("not linear"), "{text}");
    assert!(!text.contains("as machines"), "{text}");
}
