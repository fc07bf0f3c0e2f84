//! A servo of limited speed between two levels: what is said of it, and what is not.

use crate::support::{arg, json, run};
use servoid_test_support::plants::{normal, random};
use std::path::{Path, PathBuf};

/// The most that it moves in a second.
const TOP_SPEED: f64 = 280.0;

/// Time between rows \[s\].
const PERIOD_S: f64 = 0.01;

/// -60 or 60, by the sign.
fn two_levels(random: f64) -> f64 {
    60_f64.copysign(random)
}

/// -60, 0 or 60.
fn three_levels(random: f64) -> f64 {
    60.0 * (2.0 * random).trunc().clamp(-1.0, 1.0)
}

/// How a random number makes a level, and for how many rows it is held at least.
type Reference = (fn(f64) -> f64, u32);

const OF_TWO_LEVELS: Reference = (two_levels, 30);
const OF_THREE_LEVELS: Reference = (three_levels, 90);

/// Random changes between levels, and the motion of a servo whose gain is one.
fn telegraph(folder: &Path, seed: u64, top_speed: f64, (level, hold): Reference) -> PathBuf {
    let mut random = random(seed);
    let (mut command, mut at) = (0.0, 0.0);
    let mut text = "t_s,u,y\n".to_owned();
    for k in 0..3000 {
        if k % hold == 0 {
            command = level(normal(&mut random));
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
        telegraph(folder.path(), 8, TOP_SPEED, OF_TWO_LEVELS),
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

/// What `compare` prints of two servos, one of which is slower.
fn compared(reference: Reference) -> String {
    let folder = tempfile::tempdir().unwrap();
    let sides = [(8, 700.0), (9, 420.0)];
    let sides = sides.map(|(seed, speed)| telegraph(folder.path(), seed, speed, reference));
    let files = sides.each_ref().map(|side| arg(side));
    run(&[&["compare"][..], &files, &["--input", "u", "--output", "y"]].concat())
}

/// Machines would have no intervals between two levels: no time is spent on what shows nothing.
#[test]
fn machines_are_offered_where_the_recordings_may_show_them() {
    const OFFER: &str = "next: the same with --servo-model";
    let [two, three] = [OF_TWO_LEVELS, OF_THREE_LEVELS].map(compared);
    for text in [&two, &three] {
        assert!(text.contains("not linear"), "{text}");
        assert!(!text.contains("As machines"), "{text}");
    }
    assert!(!two.contains(OFFER), "{two}");
    assert!(three.contains(OFFER), "{three}");
}
