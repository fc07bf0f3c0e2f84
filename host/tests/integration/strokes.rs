//! Answers that hold for the strokes of a recording, and what is said where strokes, conditions or the travel differ.

use crate::support::{arg, json, refusal, run};
use serde_json::Value;
use std::path::{Path, PathBuf};

/// A recording of a simulated servo with this amplitude \[deg\].
fn recorded(dir: &Path, name: &str, [servo, amplitude, seed]: [&str; 3]) -> PathBuf {
    let file = dir.join(name);
    let of = ["simulate", "-q", "--servo", servo, "-o", arg(&file)];
    run(&[&of[..], &["--amplitude", amplitude, "--seed", seed]].concat());
    file
}

fn document(args: &[&str]) -> Value {
    serde_json::from_str(&run(&[args, &["-q", "--json"]].concat())).unwrap()
}

/// The advice of a model, by name.
fn checks(found: &Value) -> Vec<String> {
    let advice = found["advice"].as_array().unwrap().iter();
    advice
        .map(|item| item["check"].as_str().unwrap().to_owned())
        .collect()
}

/// A servo with a limit of its speed answers strokes of one size as a linear one does that is slower.
#[test]
fn strokes_of_one_size_are_not_said_to_show_whether_a_servo_is_linear() {
    let dir = tempfile::tempdir().unwrap();
    let one_size = recorded(dir.path(), "one.csv", ["bench", "5", "1"]);
    let text = run(&["identify", "-q", arg(&one_size)]);
    let remark = "of 10 deg, for which the bounds hold, those of bandwidth and phase among them: whether the servo is linear, and follows sines so, steps of several sizes show";
    let in_one_line = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(in_one_line(&text).contains(remark), "{text}");
    let page = dir.path().join("one.html");
    run(&["report", "-q", arg(&one_size), "-o", arg(&page)]);
    assert!(std::fs::read_to_string(&page).unwrap().contains(remark));
    let several = dir.path().join("several.csv");
    let servo = ["simulate", "-q", "--servo", "linear", "-o", arg(&several)];
    run(&[&servo[..], &["--reference", "stairs"]].concat());
    let text = run(&["identify", "-q", arg(&several)]);
    assert!(
        !in_one_line(&text).contains("of several sizes show"),
        "{text}"
    );
}

const DIFFER: &str = "the strokes differ, ±4 against ±5 deg";

#[test]
fn one_servo_under_strokes_of_two_sizes_is_not_called_two() {
    let dir = tempfile::tempdir().unwrap();
    let [small, large] = ["4", "5"].map(|amplitude| {
        recorded(
            dir.path(),
            &format!("{amplitude}.csv"),
            ["bench", amplitude, amplitude],
        )
    });
    let linear = "--no-servo-model";
    let found = document(&["compare", linear, arg(&small), arg(&large)]);
    assert_eq!(found["verdict"], "undecided");
    assert_eq!(found["descriptions_of_different_motions"], true);
    let summary = found["summary"].as_str().unwrap();
    assert!(
        summary.starts_with(&format!("Not decided by the step responses: {DIFFER}.")),
        "{summary}"
    );
    let page = dir.path().join("page.html");
    let recordings = [arg(&small), arg(&large)];
    run(&[
        &["report", "-q", linear],
        &recordings[..],
        &["-o", arg(&page)],
    ]
    .concat());
    let page = std::fs::read_to_string(&page).unwrap();
    let verdict = page.split_once("id=\"verdict\"").unwrap().1;
    let (verdict, _) = verdict.split_once("</p>").unwrap();
    assert!(verdict.contains(DIFFER), "{verdict}");
    // So are their models, which know the one size of the strokes.
    let models = [&small, &large].map(|file| file.with_extension("json"));
    for (file, model) in [&small, &large].into_iter().zip(&models) {
        let text = run(&["identify", "-q", arg(file), "-o", arg(model)]);
        assert!(
            text.contains(", the size that was recorded, the servo passes 5 %"),
            "{text}"
        );
    }
    assert_eq!(json(&models[1])["only_stroke"], 10.0);
    let found = document(&["compare", arg(&models[0]), arg(&models[1])]);
    assert_eq!(found["verdict"], "undecided");
    // Together they are runs of two kinds.
    let found = document(&["identify", arg(&small), arg(&large)]);
    let first = &found["advice"][0];
    assert_eq!(first["check"], "unlike_runs");
    assert!(
        first["finding"]
            .as_str()
            .unwrap()
            .contains("strokes of 8 deg"),
        "{first}"
    );
    assert!(!found.to_string().contains("supply voltage"));
}

#[test]
fn a_servo_that_does_not_go_as_far_as_commanded_is_named_first() {
    let dir = tempfile::tempdir().unwrap();
    let stopped = ["bench?stops-deg=-6:7", "9", "3"];
    let stopped = recorded(dir.path(), "stopped.csv", stopped);
    let model = dir.path().join("stopped.json");
    let text = run(&["identify", "-q", arg(&stopped), "-o", arg(&model)]);
    assert_eq!(checks(&json(&model))[0], "travel_end");
    let text = text.split_whitespace().collect::<Vec<_>>().join(" ");
    let said = text.find("its strokes are 0.72 of the command").unwrap();
    assert!(
        said < text.find("NO BOUNDS CAN BE GIVEN").unwrap(),
        "{text}"
    );
    let free = recorded(dir.path(), "free.csv", ["bench", "9", "3"]);
    let free = document(&["identify", "--no-servo-model", arg(&free)]);
    assert!(!checks(&free).contains(&"travel".to_owned()));
}

#[test]
fn large_strokes_have_their_top_speed_and_a_true_reason_for_what_is_left_out() {
    let dir = tempfile::tempdir().unwrap();
    let large = recorded(dir.path(), "large.csv", ["bench", "20", "1"]);
    let text = run(&["identify", "-q", arg(&large)]);
    assert!(
        text.starts_with("This servo shows no top speed and moved at more than"),
        "{text}"
    );
    assert!(
        text.contains("they rest on frequencies that were left out"),
        "{text}"
    );
    assert!(!text.contains("may be zero"), "{text}");
    let one_line = text.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(
        one_line.contains("servo is not shown to reach in this recording"),
        "{text}"
    );
    // The fastest motion of strokes that were too small is not to be read as the limit.
    let stairs = dir.path().join("stairs.csv");
    let larger = [
        "--reference",
        "stairs",
        "--amplitude",
        "30",
        "--hold",
        "0.5",
        "-o",
    ];
    run(&[
        &["simulate", "-q", "--servo", "bench"],
        &larger[..],
        &[arg(&stairs)],
    ]
    .concat());
    let text = run(&["identify", "-q", "--servo-model", arg(&stairs)]);
    assert!(
        text.starts_with("This servo is not shown at its top speed of 74")
            && text.contains("does not show the top speed: strokes may have been too small"),
        "{text}"
    );
    let page = dir.path().join("large.html");
    run(&["report", "-q", arg(&large), "-o", arg(&page)]);
    let page = std::fs::read_to_string(&page).unwrap();
    assert!(page.contains("extrapolated; "));
}

#[test]
fn a_table_of_steps_is_not_replaced_by_what_is_made_of_it() {
    let dir = tempfile::tempdir().unwrap();
    let table = dir.path().join("steps.csv");
    let steps = "angle_deg,hold_s\n5,0.5\n-5,0.5\n";
    std::fs::write(&table, steps).unwrap();
    let file = arg(&table);
    for command in ["capture", "simulate"] {
        let from = match command {
            "capture" => ["--port", "sim:bench"],
            _ => ["--servo", "bench"],
        };
        let args = [
            &[command, "--reference", file, "-o", file, "--force"][..],
            &from,
        ]
        .concat();
        refusal(&args);
        assert_eq!(std::fs::read_to_string(&table).unwrap(), steps, "{command}");
    }
}

#[test]
fn a_plan_beyond_the_limits_says_so() {
    let dir = tempfile::tempdir().unwrap();
    let rig = dir.path().join("rig.toml");
    run(&["init", "--yes", "--port", "sim:bench", "-o", arg(&rig)]);
    let plan = |amplitude| {
        let of_rig = ["plan", "-q", "--rig", arg(&rig), "--reference", "staircase"];
        run(&[&of_rig[..], &["--amplitude", amplitude]].concat())
    };
    let beyond = plan("12");
    assert!(
        beyond.contains("'servoid capture' will not run this"),
        "{beyond}"
    );
    assert!(!plan("9").contains("will not run this"));
}

/// In the short holds of a sweep a servo moves so evenly that it passes for one at rest.
#[test]
fn a_sweep_shows_no_rests_and_no_strokes() {
    let dir = tempfile::tempdir().unwrap();
    let sweep = dir.path().join("sweep.csv");
    let simulate = ["simulate", "-q", "--servo", "bench", "-o", arg(&sweep)];
    run(&[
        &simulate[..],
        &["--reference", "sweep", "--amplitude", "20"],
    ]
    .concat());
    let text = run(&["identify", "-q", arg(&sweep), "--limits"]);
    assert!(text.contains("no stroke that began"), "{text}");
    assert!(!text.contains("Hysteresis of"), "{text}");
}
