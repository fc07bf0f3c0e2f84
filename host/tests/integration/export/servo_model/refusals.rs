//! What is refused, and with which remedy.

use super::super::SUBJECT;
use super::subjects::{AIRCRAFT, SERVOS};
use crate::support::{arg, refusal, run};
use serde_json::json;
use servoid::data::model_file::ModelFile;
use servoid::presentation::export::Target;
use servoid::presentation::export::servo_model::{ServoExport, ServoExportOptions};
use std::path::Path;

fn refused(file: &Path, args: &[&str]) -> String {
    refusal(&[&["export", arg(file)], args].concat())
}

#[test]
fn a_file_without_a_servo_model_says_how_to_get_one() {
    for args in [&["--to", "c", "--servo-model"][..], &["--to", "mujoco"]] {
        let sentence = refused(&SUBJECT.file, args);
        assert!(sentence.contains("has no servo model"), "{sentence}");
        assert!(sentence.contains("--servo-model -o"), "{sentence}");
    }
}

#[test]
fn a_table_of_a_servo_model_is_refused() {
    let sentence = refused(&AIRCRAFT.file, &["--to", "csv", "--servo-model"]);
    assert!(sentence.contains("leave --servo-model out"), "{sentence}");
}

#[test]
fn a_controller_must_be_one_of_the_model() {
    let folder = tempfile::tempdir().unwrap();
    let second = SERVOS.into_iter().find(|servo| servo.name == "second");
    let file = second.unwrap().file(folder.path());
    let c = ["--to", "c", "--servo-model"];
    let sentence = refused(&file, &c);
    assert!(sentence.contains("400, 800: choose one"), "{sentence}");
    let sentence = refused(&file, &[&c[..], &["--controller", "600"]].concat());
    assert!(sentence.contains("600 is none of those"), "{sentence}");
    let sentence = refused(&AIRCRAFT.file, &[&c[..], &["--controller", "600"]].concat());
    assert!(sentence.contains("leave --controller out"), "{sentence}");
}

/// As a draw from a normal distribution may have them.
#[test]
fn a_number_that_no_servo_has_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let full = SERVOS.into_iter().find(|servo| servo.name == "full");
    let file = full.unwrap().file(folder.path());
    for (name, value, possible) in [
        ("friction_at_rest", -1e-6, "must be 0 or more"),
        ("delay", -0.001, "must be 0 to 10 s"),
        ("motor_share", 0.0, "must be more than 0"),
    ] {
        let mut document = crate::support::json(&file);
        let servo = &mut document["servo_model"];
        let names = servo["coordinates"].as_array().unwrap();
        let place = names.iter().position(|found| found == name).unwrap();
        servo["values"][place] = json!(value);
        let drawn = folder.path().join("drawn.json");
        std::fs::write(&drawn, document.to_string()).unwrap();
        let sentence = refused(&drawn, &["--to", "c", "--servo-model"]);
        let said = format!("no servo has the {name} {value}");
        assert!(
            sentence.contains(&said) && sentence.contains(possible),
            "{sentence}"
        );
        assert!(!sentence.contains("--step-ms"), "{sentence}");
    }
}

#[test]
fn a_step_that_is_too_long_names_the_longest() {
    let folder = tempfile::tempdir().unwrap();
    let file = SERVOS[1].file(folder.path());
    let args = ["--to", "mujoco", "--step-ms", "20"];
    let sentence = refused(&file, &args);
    // 0.5 of 1/ω = 1/38.73 s.
    assert!(sentence.contains("can be 12.909 at the most"), "{sentence}");
    let remedy = "--step-ms 10, and take 2 such steps in each of yours";
    assert!(
        sentence.contains("wrong by percents of a stroke") && sentence.contains(remedy),
        "{sentence}"
    );
}

#[test]
fn a_negative_step_or_frame_is_refused_in_words() {
    let sentence = refused(&AIRCRAFT.file, &["--to", "mujoco", "--step-ms", "-1"]);
    assert!(
        sentence.contains("--step-ms must be a number of milliseconds"),
        "{sentence}"
    );
    // The second is a frame in seconds.
    for frame in ["-1", "0.02"] {
        let sentence = refused(&AIRCRAFT.file, &["--to", "c", "--frame-ms", frame]);
        assert!(
            sentence.contains("--frame-ms must be a number of milliseconds"),
            "{sentence}"
        );
    }
}

#[test]
fn options_of_the_servo_model_are_not_ignored_without_it() {
    for option in [["--step-ms", "1"], ["--controller", "1"]] {
        let sentence = refused(&AIRCRAFT.file, &[&["--to", "c"], &option[..]].concat());
        assert!(sentence.contains("add --servo-model"), "{sentence}");
    }
}

#[test]
fn a_command_that_is_no_angle_cannot_turn_a_joint() {
    let folder = tempfile::tempdir().unwrap();
    let mut document = crate::support::json(&AIRCRAFT.file);
    document["units"] = json!({ "input": "us", "output": "counts" });
    let file = folder.path().join("counts.json");
    std::fs::write(&file, document.to_string()).unwrap();
    let sentence = refused(&file, &["--to", "mujoco"]);
    assert!(sentence.contains("the command is in us"), "{sentence}");
    document["units"] = json!({ "input": "counts", "output": "counts" });
    std::fs::write(&file, document.to_string()).unwrap();
    let ardupilot = ["--to", "ardupilot"];
    let sentence = refused(&file, &ardupilot);
    assert!(
        sentence.contains("state it with --full-command"),
        "{sentence}"
    );
    // It needs no angle beside it.
    let stated = [
        &["export", arg(&file), "-q"],
        &ardupilot[..],
        &["--full-command", "50"],
    ]
    .concat();
    assert!(run(&stated).contains("An output of 1 stands for 50 counts"));
}

/// JSBSim has no weight: beside one that hardly leaves the lowest place its servo follows, and is wrong by the whole stroke.
#[test]
fn a_file_that_a_servo_at_rest_would_be_better_than_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let hanging = SERVOS.into_iter().find(|servo| servo.name == "hanging");
    let file = hanging.unwrap().file(folder.path());
    let mut document = crate::support::json(&file);
    let model = &mut document["servo_model"];
    let names = model["coordinates"].as_array().unwrap();
    let gravity = names.iter().position(|name| name == "gravity").unwrap();
    model["values"][gravity] = json!(1000.0);
    std::fs::write(&file, document.to_string()).unwrap();
    for target in ["jsbsim", "ardupilot"] {
        let sentence = refused(&file, &["--to", target, "--servo-model"]);
        assert!(
            sentence.contains("would not follow its command")
                && sentence.contains("the weight")
                && sentence.contains("export to c, python, "),
            "{sentence}"
        );
    }
    run(&["export", arg(&file), "--to", "c", "--servo-model", "-q"]);
}

#[test]
fn a_full_command_is_for_ardupilot_and_reaches_the_recorded_ones() {
    let folder = tempfile::tempdir().unwrap();
    let file = super::subjects::pulses(folder.path());
    let full = |target, full| refused(&file, &["--to", target, "--full-command", full]);
    assert!(full("mujoco", "50").contains("is for --to ardupilot"));
    assert!(full("ardupilot", "0").contains("must be a command above 0"));
    assert!(full("ardupilot", "2000").contains("500 stands for a pulse of 2000 us"));
    let mut document = crate::support::json(&file);
    document["servo_model"]["commands"] = json!({ "least": 600.0, "largest": 900.0 });
    std::fs::write(&file, document.to_string()).unwrap();
    let sentence = refused(&file, &["--to", "ardupilot"]);
    assert!(
        sentence.contains("within those of ArduPilot's outputs, 1000 to 2000"),
        "{sentence}"
    );
}

/// A model file may say anything: each number in turn is one that no servo has.
#[test]
fn numbers_of_no_servo_are_refused_or_written_but_never_a_panic() {
    require_no_panic(5);
}

#[test]
#[ignore = "five seconds: cargo test -p servoid --test integration -- --ignored more_numbers_of_no_servo"]
fn more_numbers_of_no_servo_are_refused_or_written_but_never_a_panic() {
    require_no_panic(2);
}

/// Changes each number that is so many after the one before.
fn require_no_panic(apart: usize) {
    let folder = tempfile::tempdir().unwrap();
    let targets = [Target::C, Target::Jsbsim, Target::Ardupilot, Target::Mujoco];
    let mut refused = 0;
    let tilted = SERVOS.into_iter().find(|servo| servo.name == "tilted");
    let document = crate::support::json(&tilted.unwrap().file(folder.path()));
    let count = document["servo_model"]["values"].as_array().unwrap().len();
    for (k, value) in (0..count)
        .step_by(apart)
        .flat_map(|k| [(k, -1e4), (k, 700.0)])
    {
        let mut changed = document.clone();
        changed["servo_model"]["values"][k] = value.into();
        let file = ModelFile::parse(&changed.to_string(), Path::new("m.json")).unwrap();
        let model = file.servo_model().unwrap().unwrap();
        let options = ServoExportOptions::default();
        let export = ServoExport::new("m", "m.json", &model, &file.metadata, options);
        for target in targets {
            match export.as_ref().map(|export| export.write(target)) {
                Ok(Ok(written)) => {
                    let text = written.text;
                    let odd = |line: &&str| line.contains("NaN") || line.contains("inf");
                    let odd = text.lines().find(odd);
                    assert!(odd.is_none(), "{k} {value}: {odd:?}");
                }
                _ => refused += 1,
            }
        }
    }
    assert!(refused > 0);
}
