//! What is warned of on the terminal, since a file may be wrong by much.

use super::subjects::{AIRCRAFT, SERVOS, prose, pulses};
use crate::support::{arg, json, run, servoid};
use serde_json::{Value, json};
use servoid::data::Units;
use servoid::data::model_file::ModelFile;
use servoid::presentation::export::servo_model::Held;
use servoid::presentation::summary::of_servo_model;
use std::path::{Path, PathBuf};

/// The lines on standard error that are warnings, in one.
fn warnings(args: &[&str]) -> String {
    let output = servoid(args).output().unwrap();
    assert!(output.status.success());
    let said = String::from_utf8(output.stderr).unwrap();
    let lines: Vec<&str> = said
        .lines()
        .filter(|l| l.starts_with("warning: "))
        .collect();
    lines.join("\n")
}

fn exported(file: &Path, target: &str) -> String {
    warnings(&["export", arg(file), "--servo-model", "--to", target])
}

/// A copy of a model file, changed.
fn changed(file: &Path, folder: &Path, change: impl Fn(&mut Value)) -> PathBuf {
    let mut document = json(file);
    change(&mut document);
    let path = folder.join("changed.json");
    std::fs::write(&path, document.to_string()).unwrap();
    path
}

/// A file without intervals says how large the errors were.
#[test]
fn errors_that_no_interval_contains_are_stated_by_their_size() {
    let folder = tempfile::tempdir().unwrap();
    let with = |largest: Value| {
        changed(&AIRCRAFT.file, folder.path(), |document| {
            let model = &mut document["servo_model"];
            model["fit"]["rmse"] = json!(2.5);
            model["fit"]["largest_residual"] = largest.clone();
        })
    };
    for target in ["jsbsim", "c"] {
        let said = exported(&with(json!(11.25)), target);
        let size = "leaves errors of up to 11.25 deg (2.500 deg rms) in its own recording";
        assert!(said.contains(size), "{said}");
        // A file from before it was kept.
        let said = exported(&with(Value::Null), target);
        assert!(said.contains("leaves errors of 2.500 deg rms"), "{said}");
    }
    let model: Value = json(&AIRCRAFT.file);
    let fit = &model["servo_model"]["fit"];
    assert!(
        fit["largest_residual"].as_f64() > fit["rmse"].as_f64(),
        "{fit}"
    );
}

/// A drive at whose limit hardly any stroke begins, and a top speed that the recording does not determine.
#[test]
fn a_rate_limit_that_was_not_found_is_not_invented() {
    let folder = tempfile::tempdir().unwrap();
    let file = SERVOS[1].file(folder.path());
    let with = |determined: bool, factor: f64| {
        let file = changed(&file, folder.path(), |document| {
            let model = &mut document["servo_model"];
            for quantity in model["quantities"].as_array_mut().unwrap() {
                if quantity["name"].as_str().unwrap().starts_with("top speed") {
                    quantity["determined"] = json!(determined);
                }
            }
            let commands = &model["commands"];
            let end = |name: &str| commands[name].as_f64().unwrap();
            let full_drive = factor * (end("largest") - end("least"));
            // The drive of this error, at a damping of the motor of 0.67 of the whole.
            let top = full_drive * 1500.0 / (0.67 * 60.0);
            let values = model["values"].as_array_mut().unwrap();
            values[5] = json!(top.ln());
            values[6] = json!(0.67);
        });
        run(&[
            "export",
            arg(&file),
            "--servo-model",
            "--to",
            "jsbsim",
            "-q",
        ])
    };
    let text = with(false, 0.95);
    assert!(!text.contains("<rate_limit"), "{text}");
    assert!(
        prose(&text).contains("Rate: this file has no limit. The recording does not determine")
    );
    // One that was found is written, and one that makes the strokes what they are, too.
    assert!(with(true, 0.95).contains("<rate_limit"));
    assert!(with(false, 0.05).contains("<rate_limit"));
}

/// What the header says of the rate, the terminal says, too.
#[test]
fn a_rate_below_the_top_speed_is_remarked_on() {
    let output = servoid(&[
        "export",
        arg(&AIRCRAFT.file),
        "--servo-model",
        "--to",
        "jsbsim",
    ])
    .output();
    let output = output.unwrap();
    let said = String::from_utf8(output.stderr).unwrap();
    let header = prose(&String::from_utf8(output.stdout).unwrap());
    assert!(
        said.contains("in larger ones this file falls behind the servo"),
        "{said}"
    );
    assert!(header.contains("In larger strokes than the recorded ones the file falls behind"));
}

#[test]
fn pulses_that_are_called_something_else_are_seen_by_their_size() {
    let folder = tempfile::tempdir().unwrap();
    let named = pulses(folder.path());
    let with = |units: Value| {
        changed(&named, folder.path(), |model| {
            model["units"] = units.clone()
        })
    };
    let degrees = with(json!({ "input": "deg", "output": "deg" }));
    for target in ["ardupilot", "jsbsim", "mujoco", "c"] {
        let said = exported(&degrees, target);
        let doubt = "says deg, and its values, 1100 to 1596, are pulse widths in us by their size";
        assert!(said.contains(doubt), "{target}: {said}");
        assert!(!exported(&named, target).contains("by their size"));
    }
    // Nothing contradicts it where there is no unit, and the numbers are those of pulses.
    let unnamed = with(json!({ "output": "deg" }));
    let said = exported(&unnamed, "ardupilot");
    assert!(
        said.contains("names no unit") && said.contains("takes them for that"),
        "{said}"
    );
    let parameters = |file: &Path| -> Vec<String> {
        let text = run(&["export", arg(file), "--to", "ardupilot", "-q"]);
        let lines = text.lines().filter(|line| line.starts_with("SIM_"));
        lines.map(str::to_owned).collect()
    };
    assert_eq!(parameters(&unnamed), parameters(&named));
}

#[test]
fn a_column_of_pulses_with_another_name_is_remarked_on_as_it_is_read() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("a.csv");
    let row = |k: usize| {
        let u = if (k / 150).is_multiple_of(2) {
            1600
        } else {
            1400
        };
        format!("{},{u},{}\n", k as f64 * 0.002, (k * k) % 97)
    };
    let of = |name: &str| {
        let rows: String = (0..1500).map(row).collect();
        std::fs::write(&file, format!("t_s,{name},y_deg\n{rows}")).unwrap();
        let args = ["identify", arg(&file), "--input", name, "--output", "y_deg"];
        String::from_utf8(servoid(&args).output().unwrap().stderr).unwrap()
    };
    for name in ["u", "u_deg", "u_rad"] {
        let said = of(name);
        assert!(
            said.contains("1400 to 1600, are pulse widths in us by their size"),
            "{said}"
        );
    }
    assert!(!of("u_us").contains("by their size"));
}

#[test]
fn a_speed_that_no_servo_has_is_doubted_in_every_file() {
    let folder = tempfile::tempdir().unwrap();
    // Degrees that are radians turn 57 times as slowly.
    let slow = changed(&AIRCRAFT.file, folder.path(), |document| {
        let all = document["servo_model"]["quantities"]
            .as_array_mut()
            .unwrap();
        for quantity in all
            .iter_mut()
            .filter(|q| q["name"].as_str().unwrap().starts_with("top speed"))
        {
            quantity["value"] = json!(5.4);
            quantity["determined"] = json!(true);
        }
    });
    for target in ["ardupilot", "c"] {
        let said = exported(&slow, target);
        assert!(said.contains("slower than R/C servos turn"), "{said}");
        assert!(!exported(&AIRCRAFT.file, target).contains("than R/C servos turn"));
    }
    let linear = warnings(&["export", arg(&slow), "--to", "jsbsim"]);
    assert!(linear.contains("slower than R/C servos turn"), "{linear}");
}

#[test]
fn a_file_that_is_far_from_the_servo_names_what_it_leaves_out() {
    let folder = tempfile::tempdir().unwrap();
    for target in ["ardupilot", "jsbsim", "mujoco"] {
        let said = exported(&AIRCRAFT.file, target);
        assert!(
            said.contains("this file is up to ") && said.contains(" leaves out "),
            "{said}"
        );
        assert!(
            said.contains("the load of the air") && said.contains("c, python, "),
            "{said}"
        );
    }
    assert!(!exported(&AIRCRAFT.file, "c").contains("leaves out"));
    // MuJoCo has all that this one has.
    let limited = SERVOS[1].file(folder.path());
    assert!(!exported(&limited, "mujoco").contains("leaves out"));
    let stopped = SERVOS[10].file(folder.path());
    let said = exported(&stopped, "ardupilot");
    assert!(said.contains("the stops"), "{said}");
}

#[test]
fn long_steps_are_refused_or_warned_of_by_every_target() {
    let folder = tempfile::tempdir().unwrap();
    let file = SERVOS[1].file(folder.path());
    let args = |target| {
        let file = arg(&file);
        [
            "export",
            file,
            "--servo-model",
            "--to",
            target,
            "--step-ms",
            "50",
        ]
    };
    for target in ["ardupilot", "mujoco", "c"] {
        let said = crate::support::refusal(&args(target));
        assert!(said.contains("can be 12.909 at the most"), "{said}");
    }
    let said = warnings(&args("jsbsim"));
    assert!(
        said.contains("steps of 50.00 ms are long for this servo"),
        "{said}"
    );
    let usual = [
        "export",
        arg(&file),
        "--servo-model",
        "--to",
        "jsbsim",
        "--step-ms",
        "8.333",
    ];
    assert!(!warnings(&usual).contains("long for this servo"));
}

#[test]
fn a_speed_of_zero_is_not_called_reached() {
    let folder = tempfile::tempdir().unwrap();
    let linear = SERVOS[0].file(folder.path());
    let with = |speed: f64| {
        let change = |document: &mut Value| {
            document["servo_model"]["reached"] = json!({ "upwards": speed, "downwards": speed });
        };
        prose(&exported(&changed(&linear, folder.path(), change), "c"))
    };
    assert!(with(57.0).contains("was seen up to 57 deg/s upwards"));
    let said = with(0.0);
    assert!(
        said.contains("no limit of the speed was seen (commands "),
        "{said}"
    );
}

#[test]
fn a_top_speed_that_was_reached_in_the_other_direction_alone_is_marked() {
    let folder = tempfile::tempdir().unwrap();
    let with = |up: f64, down: f64| {
        let file = changed(&AIRCRAFT.file, folder.path(), |document| {
            let model = &mut document["servo_model"];
            model["reached"] = json!({ "upwards": up, "downwards": down });
            for quantity in model["quantities"].as_array_mut().unwrap() {
                let name = quantity["name"].as_str().unwrap();
                if name.starts_with("top speed") {
                    quantity["value"] = json!(300.0);
                    quantity["determined"] = json!(true);
                }
            }
        });
        let model = ModelFile::read(&file).unwrap().servo_model().unwrap();
        of_servo_model(&model.unwrap(), Units::default(), false)
    };
    let downwards = with(290.0, 200.0);
    assert!(
        downwards.contains("That the top speed downwards was reached is not shown"),
        "{downwards}"
    );
    assert!(with(200.0, 290.0).contains("That the top speed upwards was reached is not shown"));
    assert!(!with(290.0, 290.0).contains("was reached is not shown"));
}

/// The table has the speeds under the load, and the one speed stands for those without it.
#[test]
fn one_speed_names_those_that_it_stands_for() {
    let folder = tempfile::tempdir().unwrap();
    let of = |servo: usize| {
        let file = SERVOS[servo].file(folder.path());
        let output = servoid(&["export", arg(&file), "--to", "ardupilot"])
            .output()
            .unwrap();
        String::from_utf8(output.stderr).unwrap()
    };
    let said = of(6);
    assert!(
        said.contains("the model, without the load that is left out, has "),
        "{said}"
    );
    assert!(of(2).contains("where the model has "));
}

/// Even reversals in a few words, other strokes one by one.
fn named(strokes: &[Held]) -> String {
    let even = strokes.len() > 2
        && strokes.iter().all(|held| held.steps == strokes[0].steps)
        && strokes
            .windows(3)
            .all(|held| held[0].level == held[2].level);
    if even {
        let (first, second) = (&strokes[0], &strokes[1]);
        return format!(
            "{:?} and {:?} in turn, {} strokes of {} steps each",
            first.level,
            second.level,
            strokes.len(),
            first.steps
        );
    }
    let one = |held: &Held| format!("{:?} for {} steps", held.level, held.steps);
    strokes.iter().map(one).collect::<Vec<_>>().join(", ")
}

/// Every file names the strokes in which a search found the largest difference, and their half-periods.
#[test]
fn the_strokes_that_a_search_found_are_named() {
    let folder = tempfile::tempdir().unwrap();
    for target in ["jsbsim", "mujoco"] {
        let exported = SERVOS[1].export(target, folder.path(), &[]);
        let (said, trial) = (prose(&exported.text), &exported.trial);
        assert!(said.contains(&named(&trial.worst)), "{target}: {said}");
        let seconds = trial
            .worst
            .iter()
            .map(|held| held.steps as f64 * trial.step_s);
        let shortest = seconds.fold(f64::INFINITY, f64::min);
        let stated = super::subjects::number_behind(&said, "is largest, reversals of ");
        assert!(
            (stated - shortest).abs() < 1e-3 * shortest,
            "{target}: {stated}"
        );
    }
}
