//! The limit of a rate that stands for the servo's, and the trial that finds it.

use super::subjects::{AIRCRAFT, SERVOS, TARGETS, changed, export, number_behind, prose};
use serde_json::json;
use std::path::{Path, PathBuf};

#[test]
fn a_limit_of_a_rate_is_said_beside_the_top_speed() {
    let folder = tempfile::tempdir().unwrap();
    for target in ["ardupilot", "jsbsim"] {
        let text = SERVOS[1].export(target, folder.path(), &[]).text;
        let said = prose(&text);
        let limit = number_behind(&said, "the limit of theta is ");
        let share = number_behind(&said, "deg/s, which is ");
        let top = number_behind(&said, "% of the model's top speed of ");
        // Four digits are written.
        assert!((limit / top - share / 100.0).abs() < 1e-3, "{said}");
        let written = match target {
            "ardupilot" => 60.0 / number_behind(&text, "\nSIM_SERVO_SPEED "),
            _ => {
                let (_, rest) = text.split_once("sense=\"incr\">").unwrap();
                rest.split('<').next().unwrap().parse().unwrap()
            }
        };
        assert!((written / limit - 1.0).abs() < 1e-3, "{written} {said}");
    }
}

#[test]
fn limits_of_rates_are_those_of_the_whole_range_of_the_recording() {
    let model = crate::support::json(&AIRCRAFT.file)["servo_model"].clone();
    let number = |value: &serde_json::Value| value.as_f64().unwrap();
    let range = number(&model["commands"]["largest"]) - number(&model["commands"]["least"]);
    for target in TARGETS {
        let exported = export(&AIRCRAFT.file, 0, target, &[]);
        let stroke = exported.largest_stroke() / exported.servo.gain.abs();
        assert!(
            (0.98..1.02).contains(&(stroke / range)),
            "{target}: {stroke} {range}"
        );
        assert!(
            prose(&exported.text).contains("(the recording has commands from -"),
            "{target}"
        );
    }
}

/// What was reached is said beside the rate, in units of theta, and does not move it.
#[test]
fn a_rate_is_the_same_whatever_was_reached() {
    let folder = tempfile::tempdir().unwrap();
    let file = SERVOS[1].file(folder.path());
    let of = |target: &str, speed: f64| {
        let mut document = crate::support::json(&file);
        document["servo_model"]["reached"] = json!({ "upwards": 1.02 * speed, "downwards": 51.0 });
        std::fs::write(&file, document.to_string()).unwrap();
        prose(&export(&file, 0, target, &[]).text)
    };
    for target in ["ardupilot", "jsbsim"] {
        let [slow, fast] = [40.0, 240.0].map(|speed| of(target, speed));
        let rate = |said: &str| number_behind(said, "the limit of theta is ");
        assert_eq!(rate(&slow), rate(&fast), "{target}");
        let said = "In the recording theta reached 240 deg/s upwards and 50 deg/s downwards at least; the limit need not be that";
        assert!(fast.contains(said), "{target}: {fast}");
    }
    let unequal = SERVOS[2].export("ardupilot", folder.path(), &[]);
    let said = prose(&unequal.text);
    assert!(
        said.contains("One rate stands for both directions"),
        "{said}"
    );
}

/// The file of a servo whose drive is limited and that has nothing else, with these coordinates and commands between these.
fn of_limited_drive(
    folder: &Path,
    values: [(&str, f64); 7],
    [least, largest]: [f64; 2],
) -> PathBuf {
    changed(folder, |model| {
        model["terms"] = json!({
            "limit": true, "two_speeds": false, "dead_band": false, "friction": false,
            "friction_of_gears": false, "load": "none",
        });
        let (names, values): (Vec<&str>, Vec<f64>) = values.into_iter().unzip();
        model["coordinates"] = json!(names);
        model["values"] = json!(values);
        model["alternatives"] = json!([]);
        model["commands"] = json!({ "least": least, "largest": largest });
    })
}

/// One of large full drive speed and small full drive, which spends a stroke in building speed up and braking.
#[test]
fn the_first_strokes_of_a_trial_end() {
    let folder = tempfile::tempdir().unwrap();
    let values = [
        ("delay", 0.021),
        ("ln_stiffness", 6700f64.ln()),
        ("ln_damping", 128f64.ln()),
        ("gain", 1.0),
        ("offset", 0.0),
        ("ln_top_speed", 740f64.ln()),
        ("motor_share", 0.074),
    ];
    let file = of_limited_drive(folder.path(), values, [-30.0, 30.0]);
    let exported = export(&file, 0, "jsbsim", &[]);
    let (steps, strokes) = (
        exported.trial.steps_per_level,
        exported.trial.staircase(&exported.exact),
    );
    for (level, command) in exported.trial.levels.iter().enumerate() {
        let end = strokes[(level + 1) * steps - 1];
        let rest = exported.servo.resting_output(*command);
        // That within which a stroke counts as done.
        let share = (end - rest).abs() / exported.largest_stroke();
        assert!(share < 0.02, "{command}: {share}");
    }
}

/// Of one that is hardly damped where its drive is full. Even reversals of 0.217 s make it swing ever farther, in a band of half-periods of a few
/// hundredths: in MuJoCo its joint is 3.5 deg away after 24 strokes, and 1.3 deg after 16 of the nearest of twelve half-periods.
#[test]
fn the_search_finds_the_half_period_in_which_swings_grow() {
    let folder = tempfile::tempdir().unwrap();
    let values = [
        ("delay", 0.006),
        ("ln_stiffness", 1195f64.ln()),
        ("ln_damping", 45.8f64.ln()),
        ("gain", 0.964),
        ("offset", 0.48),
        ("ln_top_speed", 417.5f64.ln()),
        ("motor_share", 0.1526),
    ];
    let file = of_limited_drive(folder.path(), values, [-14.77, 14.9]);
    let exported = export(&file, 0, "mujoco", &["--frame-ms", "0"]);
    assert!(exported.stated > 3.5, "{}", exported.stated);
}

/// Loops run in round steps.
#[test]
fn a_step_without_a_choice_is_a_round_one() {
    let folder = tempfile::tempdir().unwrap();
    for servo in SERVOS {
        for target in ["c", "mujoco"] {
            let step_ms = 1e3 * servo.export(target, folder.path(), &[]).trial.step_s;
            let round = [10.0, 5.0, 2.0, 1.0, 0.5, 0.2, 0.1];
            assert!(
                round
                    .iter()
                    .any(|round| (step_ms / round - 1.0).abs() < 1e-9),
                "{step_ms}"
            );
        }
    }
}
