//! Model files: the formats of now and before, kept as they are, and files that are nearly models.

use crate::no_bounds::require_no_bound;
use crate::support::data;
use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use serde_json::Value;
use servoid::data::model_file::{ModelFile, ModelFileError};
use servoid::data::{ModelMetadata, Units};
use servoid::presentation::export::{Export, Target};
use servoid::presentation::plots::{difference, draw};
use servoid::presentation::report::{self, Page, Servo};
use servoid::presentation::summary;
use servoid_identification::Record;
use servoid_identification::comparison::{ComparisonOptions, compare_models};
use servoid_identification::results::Bounds;
use std::path::Path;
use std::sync::LazyLock;

/// What `servoid identify --settling 21 --noise-order 1 --flight-model` wrote when schema 1 was made.
static SCHEMA_1: LazyLock<String> = LazyLock::new(|| golden("model-schema-1.json"));

/// The same model as schema 2 has it.
static SCHEMA_2: LazyLock<String> = LazyLock::new(|| golden("model-schema-2.json"));

fn golden(name: &str) -> String {
    std::fs::read_to_string(data(name)).expect("the file is there")
}

fn document(text: &str) -> Value {
    serde_json::from_str(text).unwrap()
}

fn read(text: &str) -> Result<ModelFile, ModelFileError> {
    ModelFile::parse(text, Path::new("m.json"))
}

fn refused(value: &Value) -> String {
    read(&value.to_string()).unwrap_err().to_string()
}

/// What is written today of a model that was read.
fn written(file: &ModelFile) -> Value {
    let mut again = serde_json::to_value(&file.model).unwrap();
    again["flight_model"] = serde_json::to_value(file.flight_model().unwrap()).unwrap();
    again
}

#[test]
fn a_model_that_says_the_wrong_schema_is_refused_in_words() {
    let mut changed = document(&SCHEMA_2);
    changed["schema"] = 1.into();
    let theta = changed["theta"].as_array().unwrap().len();
    changed["theta"] = vec![Value::Null; theta].into();
    let sentence = refused(&changed);
    for part in [
        "says that it is of schema 1, and is not laid out like that",
        "write 2 there again",
    ] {
        assert!(sentence.contains(part), "{sentence}");
    }
}

#[test]
fn a_model_of_schema_1_is_read_with_all_its_numbers() {
    let file = read(&SCHEMA_1).unwrap();
    let (model, old) = (&file.model, document(&SCHEMA_1));
    let structure = &model.structure;
    assert_eq!(
        (structure.settling_samples, structure.frequencies),
        (21, 21)
    );
    assert_eq!((structure.noise_order, model.noise.ar.len()), (1, 1));
    assert_eq!((model.sample_period_s, model.theta.len()), (0.02, 21));
    // To the last digit: the same text gives the same number.
    assert_eq!(Some(model.theta[0]), old["theta"][0].as_f64());
    assert_eq!(model.metrics.dc_gain.value, Some(0.9978859665810444));
    assert_eq!(model.frequency.omega_rad_s.len(), 120);
    assert!(model.linear && model.metrics.withheld.is_none());
    assert_eq!(model.level(), Bounds::Valid(0.99));
    let flight = file.flight_model().unwrap().expect("it carries one");
    assert_eq!((flight.order, flight.tried.len()), (2, 3));
    // Written today, bounds stand in objects of their own.
    let new = written(&file);
    assert_eq!(new["schema"], 2);
    assert_eq!(new["bounds"]["covariance"], old["covariance"]);
    assert_eq!(new["metrics"]["delay_s"], old["metrics"]["delay_s"]);
    let (step, old_step) = (&new["step"], &old["step"]);
    assert_eq!(step["value"], old_step["value"]);
    for bound in ["sd", "truncation_bias"] {
        assert_eq!(step["bounds"][bound], old_step[bound], "{bound}");
    }
    for band in ["pointwise", "simultaneous"] {
        for bound in ["lower", "upper"] {
            assert_eq!(step["bounds"][band][bound], old_step[band][bound]);
        }
    }
    for bound in ["magnitude_db_lower", "phase_deg_upper"] {
        assert_eq!(new["frequency"]["bounds"][bound], old["frequency"][bound]);
    }
    let (flight, old_flight) = (&new["flight_model"], &old["flight_model"]);
    assert_eq!(flight["bounds"]["covariance"], old_flight["covariance"]);
    assert_eq!(flight["gain"], old_flight["gain"]);
}

#[test]
fn a_model_of_schema_1_whose_bounds_did_not_hold_is_read_without_any() {
    for (checks, reason) in [
        (&["model_error"][..], "errors_not_noise"),
        (&["rounding"], "quantisation_above_noise"),
        (
            &["rounding", "model_error", "excitation"],
            "input_unexcited",
        ),
    ] {
        let mut old = document(&SCHEMA_1);
        old["advice"] = checks
            .iter()
            .map(|check| {
                serde_json::json!({
                    "check": check, "finding": "x", "value": 1, "threshold": 0, "do": "y"
                })
            })
            .collect();
        let file = read(&old.to_string()).unwrap();
        let new = written(&file);
        assert_eq!(new["withdrawn"]["reason"], reason);
        assert_eq!(file.model.linear, !checks.contains(&"model_error"));
        require_no_bound(&new, "");
        assert_eq!(new["step"]["value"], old["step"]["value"]);
    }
}

#[test]
fn models_of_todays_format_are_read_and_written_as_they_were() {
    for (name, holds) in [
        ("model-schema-2.json", true),
        ("model-schema-2-withdrawn.json", false),
    ] {
        let text = golden(name);
        let file = read(&text).unwrap();
        assert_eq!(file.model.bounds.valid().is_some(), holds, "{name}");
        let new = written(&file);
        // Every field of then is there; some may have been added.
        require_in(&new, &document(&text), "");
        if !holds {
            require_no_bound(&new, name);
        }
    }
}

/// Every value of `old` is in `new`, at its place; what stands beside a model is not written with it.
fn require_in(new: &Value, old: &Value, place: &str) {
    match (new, old) {
        (Value::Object(new), Value::Object(old)) => {
            let beside = ["/runs_crc32", "/units", "/pulse_frame_s"];
            for (key, old) in old {
                let place = format!("{place}/{key}");
                if !beside.contains(&place.as_str()) {
                    require_in(new.get(key).unwrap_or(&Value::Null), old, &place);
                }
            }
        }
        (new, old) => assert_eq!(new, old, "{place}"),
    }
}

#[test]
fn a_newer_model_is_named_as_such_and_fields_that_are_new_are_passed_over() {
    let mut newer = document(&SCHEMA_2);
    newer["schema"] = 3.into();
    assert!(refused(&newer).contains("made by a newer servoid"));
    // Versions change when a field changes its meaning; one that is added changes nothing that is there.
    for text in [&*SCHEMA_1, &*SCHEMA_2] {
        let richer = text.replacen('{', "{ \"colour\": \"blue\",", 1).replacen(
            "\"metrics\": {",
            "\"metrics\": { \"jerk\": {\"value\": 3},",
            1,
        );
        assert!(richer.contains("colour") && richer.contains("jerk"));
        assert!(read(&richer).unwrap().model == read(text).unwrap().model);
    }
}

#[test]
fn a_model_from_before_some_fields_were_added_is_read() {
    let mut older = document(&SCHEMA_1);
    let metrics = older["metrics"].as_object_mut().unwrap();
    for field in ["t50_s", "phase_minus_90_rad_s"] {
        metrics.remove(field).expect("it is there today");
    }
    older.as_object_mut().unwrap().remove("flight_model");
    let model = read(&older.to_string()).unwrap().model;
    assert_eq!(model.metrics.t50_s.value, None);
    assert_eq!(model.theta, read(&SCHEMA_1).unwrap().model.theta);
}

#[test]
fn a_model_that_contradicts_itself_is_refused() {
    let changes: [(&str, Value); 14] = [
        ("/structure/settling_samples", 22.into()),
        ("/structure/settling_samples", u64::MAX.into()),
        ("/structure/frequencies", 20.into()),
        ("/structure/noise_order", 2.into()),
        ("/structure/noise_order", u64::MAX.into()),
        ("/theta", serde_json::json!([1.0])),
        ("/bounds/covariance/3", serde_json::json!([])),
        ("/step/bounds/sd", serde_json::json!([])),
        ("/step/bounds/level", 1.0.into()),
        ("/step/bounds/truncation_bias", (-1.0).into()),
        ("/sample_period_s", 0.0.into()),
        ("/sample_period_s", 1e300.into()),
        // Bounds that are there in part.
        ("/bounds/level", 0.9.into()),
        ("/metrics/bounds/level", 0.9.into()),
    ];
    for (place, value) in changes {
        let mut file = document(&SCHEMA_2);
        *file.pointer_mut(place).expect(place) = value.clone();
        let said = refused(&file);
        assert!(
            said.contains("contradicts itself"),
            "{place} {value}: {said}"
        );
    }
    let mut neither = document(&SCHEMA_2);
    neither["step"]["bounds"] = Value::Null;
    assert!(refused(&neither).contains("withdrawn with a reason"));
    let mut partly = document(&golden("model-schema-2-withdrawn.json"));
    partly["metrics"]["dc_gain"]["lower"] = 0.5.into();
    assert!(refused(&partly).contains("contradicts itself"));
}

/// Everything that is done with a model from a file.
fn use_model(text: &str) {
    let Ok(file) = read(text) else { return };
    let flight = file.flight_model().ok().flatten();
    let ModelFile {
        model, metadata, ..
    } = file;
    let export = Export::new("m", "m.json", &model, flight, metadata);
    for target in Target::ALL {
        let _some_have_no_form = export.write(target);
    }
    assert!(
        !summary::of_model(
            "m",
            &model,
            &ModelMetadata::default(),
            summary::Extent::default()
        )
        .is_empty()
    );
    let input: Vec<f64> = (0..100).map(|k| f64::from(k / 7 % 2)).collect();
    if let Ok(record) = Record::of_run(model.sample_period_s, &input, &input) {
        let _may_not_apply = model.validate(&record);
    }
    let other = read(&SCHEMA_1).unwrap().model;
    for (a, b) in [(&other, &model), (&model, &other)] {
        let found = compare_models(a, b, &ComparisonOptions::default()).ok();
        let (first, second) = [(a, "a"), (b, "b")]
            .map(|(model, name)| {
                Servo::of_model(name.into(), model.clone(), ModelMetadata::default())
            })
            .into();
        let _may_have_no_form = report::page(&Page {
            title: "m",
            first: first.part(),
            second: Some(second.part()),
            comparison: found.as_ref(),
            servo_models: None,
            paper: &[],
        });
        if let Some(found) = found {
            let _ = summary::of_comparison(&found, None, Units::default());
            let _ = draw(&difference("m", "m", "a", "b", &found));
        }
    }
}

/// Where the numbers of a text are.
fn numbers(text: &str) -> Vec<std::ops::Range<usize>> {
    let is_part = |c: char| c.is_ascii_digit() || "+-.eE".contains(c);
    let mut found = Vec::new();
    let mut rest = 0;
    while let Some(begin) = text[rest..].find(|c: char| c.is_ascii_digit() || c == '-') {
        let begin = rest + begin;
        let length = text[begin..]
            .find(|c| !is_part(c))
            .unwrap_or(text.len() - begin);
        found.push(begin..begin + length);
        rest = begin + length;
    }
    found
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 100,
        rng_seed: RngSeed::Fixed(1),
        failure_persistence: None,
        ..ProptestConfig::default()
    })]
    /// Numbers that no servo has, wherever a number is: refused, or worked with.
    #[test]
    fn nearly_a_model(
        places in prop::collection::vec(any::<prop::sample::Index>(), 1..4),
        of_today in any::<bool>(),
        number in prop::sample::select(vec![
            "0", "-1", "1", "3", "5000", "4294967296", "18446744073709551615",
            "1e-300", "-1e-75", "1e75", "-1e75", "1e300", "-1e308", "0.5", "null",
        ]),
    ) {
        let mut text = if of_today { SCHEMA_2.clone() } else { SCHEMA_1.clone() };
        for place in places {
            let numbers = numbers(&text);
            text.replace_range(numbers[place.index(numbers.len())].clone(), number);
        }
        use_model(&text);
    }
}
