//! The JSON of the commands is what `docs/results.md` says.

use crate::support::{arg, run};
use serde_json::Value;
use std::path::Path;

/// Names of all fields, at any depth.
fn fields(value: &Value, found: &mut Vec<String>) {
    match value {
        Value::Object(object) => {
            for (key, value) in object {
                found.push(key.clone());
                fields(value, found);
            }
        }
        Value::Array(list) => list.iter().for_each(|value| fields(value, found)),
        _ => {}
    }
}

#[test]
fn every_field_is_documented() {
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/results.md");
    let page = std::fs::read_to_string(page).unwrap();
    let dir = tempfile::tempdir().unwrap();
    let at = |name: &str| arg(&dir.path().join(name)).to_owned();
    let (out, bench, loaded) = (at("demo"), at("demo/bench.csv"), at("demo/aircraft.csv"));
    let (model, header) = (at("demo/bench.json"), at("x.h"));
    let (rig, run_file) = (at("rig.toml"), at("run.csv"));
    let results = [
        vec![
            "plan",
            "--band",
            "1",
            "--servo-model",
            "--reference",
            "stairs",
            "--hold",
            "0.5",
        ],
        vec!["init", "--yes", "-o", &rig],
        vec!["info", "--port", "sim:bench"],
        vec!["calibrate", "--port", "sim:bench", "--by-servo"],
        vec!["calibrate", "--port", "sim:aircraft", "--travel-only"],
        vec![
            "calibrate",
            "--port",
            "sim:bench?stops-deg=-30:35",
            "--travel-only",
        ],
        vec![
            "capture",
            "--port",
            "sim:linear",
            "--until-band",
            "2",
            "-o",
            &run_file,
        ],
        vec![
            "capture",
            "--port",
            "sim:linear",
            "--repeat",
            "2",
            "--force",
            "-o",
            &run_file,
        ],
        vec!["simulate", "--servo", "linear", "--force", "-o", &run_file],
        vec!["demo", "--out", &out],
        vec!["identify", &bench],
        vec!["identify", &loaded, "--servo-model"],
        vec!["validate", &model, &loaded],
        vec!["compare", &bench, &loaded, "--servo-model"],
        vec!["compare", &model, &model],
        vec!["export", &model, "--to", "c"],
        vec!["export", &model, "--to", "c", "-o", &header],
    ];
    for args in results {
        let printed = run(&[&args[..], &["--json"]].concat());
        let value: Value = serde_json::from_str(&printed).unwrap();
        let mut found = Vec::new();
        fields(&value, &mut found);
        assert!(!found.is_empty());
        for field in found {
            assert!(
                page.contains(&format!("`{field}`")),
                "{args:?}: {field} is not in docs/results.md"
            );
        }
    }
    // Which serial ports there are is the machine's business; each has these fields.
    let ports: Value = serde_json::from_str(&run(&["ports", "--json"])).unwrap();
    let mut found = ["port", "device", "rig", "error"]
        .map(str::to_owned)
        .to_vec();
    fields(&ports, &mut found);
    assert!(
        found
            .iter()
            .all(|field| page.contains(&format!("`{field}`")))
    );
    // What is asked for beside the model: the fields that the page names.
    let more = ["--explain", "--flight-model", "--limits", "--json"];
    let value: Value =
        serde_json::from_str(&run(&[&["identify", &loaded], &more[..]].concat())).unwrap();
    for part in ["explanation", "flight_model", "limits", "directions"] {
        for field in value[part].as_object().unwrap().keys() {
            assert!(page.contains(&format!("`{field}`")), "{part}: {field}");
        }
    }
}

#[test]
fn a_model_file_is_what_is_printed() {
    let dir = tempfile::tempdir().unwrap();
    let at = |name: &str| arg(&dir.path().join(name)).to_owned();
    let (recording, model) = (at("run.csv"), at("model.json"));
    run(&["simulate", "--servo", "linear", "-o", &recording]);
    let printed = run(&[
        "identify",
        &recording,
        "--explain",
        "--flight-model",
        "--limits",
        "--json",
        "-o",
        &model,
    ]);
    assert_eq!(std::fs::read_to_string(&model).unwrap(), printed);
    // Other commands pass over what they do not need.
    run(&["validate", &model, &recording]);
}
