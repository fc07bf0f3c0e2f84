//! Where no bounds can be given, none are shown: not as numbers, not as curves, not in a caption.

use crate::report::embedded;
use crate::support::{arg, json, run};
use serde_json::Value;
use std::path::{Path, PathBuf};

/// A servo whose speed is limited, under random steps that do not let it rest: its errors are not noise.
fn limited(dir: &Path, seed: u32) -> PathBuf {
    const PERIOD: f64 = 0.002;
    let (mut random, mut noise, mut level) = (seed, 7 * seed + 1, 5.0);
    let next = |state: &mut u32| {
        *state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f64::from(*state >> 8) / f64::from(1 << 24)
    };
    let (mut position, mut speed) = (level, 0.0);
    let mut rows = String::from("time_s,u [us],y [deg]\n");
    for k in 0..3600 {
        if k % 10 == 0 {
            level = if next(&mut random) > 0.5 { 5.0 } else { -5.0 };
        }
        // Second order, 60 rad/s and damping 0.7, ten steps a sample, 100 degrees a second at most.
        for _ in 0..10 {
            let acceleration = 3600.0 * (level - position) - 84.0 * speed;
            speed = (speed + acceleration * PERIOD / 10.0).clamp(-100.0, 100.0);
            position += speed * PERIOD / 10.0;
        }
        let error = 0.07 * (next(&mut noise) - 0.5);
        let time = f64::from(k) * PERIOD;
        rows += &format!("{time:.3},{level},{:.4}\n", position + error);
    }
    let file = dir.join(format!("limited-{seed}.csv"));
    std::fs::write(&file, rows).unwrap();
    file
}

const NAMED: [&str; 4] = ["--input", "u", "--output", "y"];

/// Fields that are bounds, or of which bounds are made.
fn is_bound(key: &str) -> bool {
    const BOUNDS: [&str; 22] = [
        "level",
        "lower",
        "upper",
        "sd",
        "critical_value",
        "covariance",
        "truncation_bias",
        "rounding_bias",
        "bias",
        "magnitude_db_lower",
        "magnitude_db_upper",
        "phase_deg_lower",
        "phase_deg_upper",
        "pointwise",
        "simultaneous",
        "difference_percent",
        "at_least",
        "at_most",
        "run_to_run_at_most_percent",
        "a_bounds",
        "b_bounds",
        "delay_shift_bounds_s",
    ];
    BOUNDS.contains(&key)
}

/// No bound in a document is a number, nor has numbers in it.
pub fn require_no_bound(value: &Value, place: &str) {
    match value {
        Value::Object(object) => {
            for (key, value) in object {
                let place = format!("{place}/{key}");
                if is_bound(key) || key == "bounds" {
                    assert!(value.is_null(), "{place} is {value}");
                }
                // Beside the model: how the search for its structure went.
                if key != "explanation" {
                    require_no_bound(value, &place);
                }
            }
        }
        Value::Array(list) => list.iter().for_each(|value| require_no_bound(value, place)),
        _ => {}
    }
}

#[test]
fn identify_compare_and_export_show_no_bounds() {
    let dir = tempfile::tempdir().unwrap();
    let [a, b] = [1, 2].map(|seed| limited(dir.path(), seed));
    let model = dir.path().join("a.json");
    let told = run(&[
        &[
            "identify",
            "-q",
            arg(&a),
            "-o",
            arg(&model),
            "--flight-model",
        ],
        &NAMED[..],
    ]
    .concat());
    assert!(told.contains("NO BOUNDS CAN BE GIVEN"), "{told}");
    let (table, _) = told.split_once("\n\n  ! ").unwrap();
    assert!(!table.contains(" .. ") && !table.contains("99 %"), "{told}");
    for gone in ["bounds of the gain", "bands contain", "bounds hold"] {
        assert!(!told.contains(gone), "{told}");
    }
    // The gain has the unit of its columns.
    let gain = table.lines().find(|line| line.contains("DC gain")).unwrap();
    assert!(gain.trim_end().ends_with("deg/us"), "{gain}");

    let file = dir.path().join("compared.json");
    let args = ["compare", "-q", arg(&a), arg(&b), "-o", arg(&file)];
    let told = run(&[&args[..], &NAMED[..]].concat());
    let (facts, _) = told.split_once("\n\n  ! ").unwrap();
    assert!(facts.contains("Not decided"), "{told}");
    assert!(
        !facts.contains(" .. ") && !facts.contains("interval"),
        "{told}"
    );

    let compared = json(&file);
    assert!(compared["bounds"].is_null());
    assert_eq!(compared["withdrawn"]["reason"], "errors_not_noise");
    require_no_bound(&compared, "comparison");
    let curves = compared["curves"].as_array().unwrap();
    assert!(!curves.is_empty());
    for curve in curves {
        let percent = curve["percent"].as_array().unwrap();
        assert!(percent.iter().all(Value::is_number));
    }

    assert!(!json(&model)["advice"].as_array().unwrap().is_empty());
    let exported = run(&["export", arg(&model), "--to", "python", "-q"]);
    assert!(exported.contains("BOUNDS_HOLD = False"), "{exported}");
    assert!(exported.contains("Bounds: none can be given"), "{exported}");
    assert!(!exported.contains("intervals of"), "{exported}");
}

#[test]
fn a_report_draws_no_bounds_and_its_captions_promise_none() {
    let dir = tempfile::tempdir().unwrap();
    let [a, b] = [1, 2].map(|seed| limited(dir.path(), seed));
    let page = dir.path().join("x.html");
    run(&[
        &["report", "-q", arg(&a), arg(&b), "-o", arg(&page)],
        &NAMED[..],
    ]
    .concat());
    let text = std::fs::read_to_string(&page).unwrap();
    let (body, _) = text.split_once("id=\"figures\"").unwrap();
    for gone in [
        "holds the whole curve",
        "are bounds for each",
        "difference<br>",
    ] {
        assert!(!body.contains(gone), "{gone}");
    }
    assert!(body.contains("No bounds can be given for limited-1 and limited-2"));
    let figures = embedded(&text, "figures");
    for figure in figures.as_array().unwrap() {
        let name = figure["name"].as_str().unwrap();
        assert_ne!(name, "difference");
        if !(name.contains("step") || name.contains("frequency")) {
            continue;
        }
        for trace in figure["data"].as_array().unwrap() {
            let label = trace["name"].as_str().unwrap();
            assert!(label.ends_with("no bounds can be given"), "{name}: {label}");
            assert!(trace.get("fill").is_none(), "{name}: {label} is an area");
        }
        if name.contains("step") {
            let axis = figure["layout"]["yaxis"]["title"]["text"].as_str().unwrap();
            assert!(axis.ends_with("(deg/us)"), "{axis}");
        }
    }
}
