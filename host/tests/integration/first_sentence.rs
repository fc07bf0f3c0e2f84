//! What the first sentence says is what the rest of the page says, and true of real recordings.

use crate::support::{arg, data, json, run};
use serde_json::Value;
use std::path::Path;

/// The text of an identification of real data, and its document.
fn identified(file: &Path, more: &[&str]) -> (String, Value) {
    let folder = tempfile::tempdir().unwrap();
    let model = folder.path().join("model.json");
    let args = ["identify", "-q", arg(file), "--input", "u", "--output", "y"];
    let text = run(&[&args[..], more, &["-o", arg(&model)]].concat());
    (text, json(&model))
}

/// A motor under stairs, whose errors are not noise, and whose model as a machine has no term that a linear servo has not. It turned by 32 degrees
/// between two rows of 20 ms, and by as much between the next two.
#[test]
fn a_servo_that_is_not_linear_may_have_a_linear_machine() {
    let file = data("dcmotor_position_stairs.csv");
    let (text, document) = identified(&file, &["--at-rest", "0", "--servo-model"]);
    assert!(
        text.starts_with(
            "This servo is not linear, in a way that no term of a model of it as a machine shows, and moved at more than\n1"
        ),
        "{text}"
    );
    assert!(
        text.contains("servo model: linear, of second order"),
        "{text}"
    );
    assert_eq!(document["linear"], false);
    let reached = document["servo_model"]["reached"]["upwards"]
        .as_f64()
        .unwrap();
    assert!((1200.0..=1607.2).contains(&reached), "{reached}");
    let figure = format!("{} units/s", 100.0 * (reached / 100.0).floor());
    assert!(text.contains(&figure), "{figure}: {text}");
    // Hardly a row of each stroke is in motion: the figures stand with what is known of them.
    assert!(
        text.contains("passes 5 % of its way after at most "),
        "{text}"
    );
}

/// A hobby servo in runs of several kinds. All together show no less than some of them, and no more than two rows have.
#[test]
fn more_runs_never_moved_slower() {
    let whole = std::fs::read_to_string(data("miuzei_rc_servo_large.csv")).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let reached = |rows: usize| {
        let path = folder.path().join(format!("{rows}.csv"));
        let kept: Vec<&str> = whole.lines().take(1 + rows).collect();
        std::fs::write(&path, kept.join("\n")).unwrap();
        let (text, document) = identified(&path, &["--run", "run", "--at-rest", "0"]);
        assert!(text.contains("moved at more than "), "{text}");
        let reached = &document["recorded"]["reached"];
        assert_eq!(reached, &document["servo_model"]["reached"]);
        ["upwards", "downwards"].map(|way| reached[way].as_f64().unwrap())
    };
    let [some, more] = [750, 1350].map(reached);
    for (some, more, most) in [(some[0], more[0], 281.5), (some[1], more[1], 382.5)] {
        assert!(
            0.8 * most < more && some <= more && more <= most,
            "{some} {more} {most}"
        );
    }
}
