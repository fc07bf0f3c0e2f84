//! Model files: today's format, kept as it is, and files that are nearly models.

use crate::support::data;
use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use serde_json::Value;
use servoid::export::{Export, Target};
use servoid::model_metadata::ModelMetadata;
use servoid::output_files::{parse_flight_model, parse_model};
use servoid::plots::{difference::difference, svg};
use servoid::report::{self, Page, Servo};
use servoid::summary;
use servoid_identification::comparison::{ComparisonOptions, compare_models};
use servoid_identification::{Model, Record};
use std::path::Path;
use std::sync::LazyLock;

/// What `servoid identify --settling 21 --noise-order 1 --flight-model` wrote when schema 1 was made.
static GOLDEN: LazyLock<String> = LazyLock::new(|| {
    std::fs::read_to_string(data("model-schema-1.json")).expect("the file is there")
});

fn golden() -> Value {
    serde_json::from_str(&GOLDEN).unwrap()
}

fn read(text: &str) -> anyhow::Result<Model> {
    parse_model(text, Path::new("m.json"))
}

fn refused(value: &Value) -> String {
    read(&value.to_string()).unwrap_err().to_string()
}

#[test]
fn a_model_of_todays_format_is_read_and_written_as_it_was() {
    let model = read(&GOLDEN).unwrap();
    let structure = &model.structure;
    assert_eq!(
        (structure.settling_samples, structure.frequencies),
        (21, 21)
    );
    assert_eq!((structure.noise_order, model.noise.ar.len()), (1, 1));
    assert_eq!((model.sample_period_s, model.theta.len()), (0.02, 21));
    // To the last digit: the same text gives the same number.
    let file = golden();
    assert_eq!(Some(model.theta[0]), file["theta"][0].as_f64());
    assert_eq!(model.metrics.dc_gain.value, Some(0.9978859665810444));
    assert_eq!(model.step.simultaneous.lower.len(), 21);
    assert_eq!(model.frequency.omega_rad_s.len(), 120);
    let flight = parse_flight_model(&GOLDEN, Path::new("m.json")).unwrap();
    let flight = flight.expect("it carries one");
    assert_eq!((flight.order, flight.tried.len()), (2, 3));
    // What is written today has every field of then; some may have been added.
    let mut again = serde_json::to_value(&model).unwrap();
    again["flight_model"] = serde_json::to_value(&flight).unwrap();
    require_in(&again, &file, "");
}

/// Every value of `old` is in `new`, at its place.
fn require_in(new: &Value, old: &Value, place: &str) {
    match (new, old) {
        (Value::Object(new), Value::Object(old)) => {
            for (key, old) in old {
                let new = new.get(key).unwrap_or(&Value::Null);
                require_in(new, old, &format!("{place}/{key}"));
            }
        }
        (new, old) => assert_eq!(new, old, "{place}"),
    }
}

#[test]
fn a_newer_model_is_named_as_such_and_fields_that_are_new_are_passed_over() {
    let mut newer = golden();
    newer["schema"] = 2.into();
    assert!(refused(&newer).contains("made by a newer servoid"));
    // Versions change when a field changes its meaning; one that is added changes nothing that is there.
    let richer = GOLDEN.replacen('{', "{ \"colour\": \"blue\",", 1).replacen(
        "\"metrics\": {",
        "\"metrics\": { \"jerk\": 3,",
        1,
    );
    assert!(richer.contains("colour") && richer.contains("jerk"));
    assert!(read(&richer).unwrap() == read(&GOLDEN).unwrap());
}

#[test]
fn a_model_from_before_some_fields_were_added_is_read() {
    let mut older = golden();
    let metrics = older["metrics"].as_object_mut().unwrap();
    for field in ["t50_s", "phase_minus_90_rad_s"] {
        metrics.remove(field).expect("it is there today");
    }
    older.as_object_mut().unwrap().remove("flight_model");
    let model = read(&older.to_string()).unwrap();
    assert_eq!(model.metrics.t50_s.value, None);
    assert_eq!(model.theta, read(&GOLDEN).unwrap().theta);
}

#[test]
fn a_model_that_contradicts_itself_is_refused() {
    let changes: [(&str, Value); 12] = [
        ("/structure/settling_samples", 22.into()),
        ("/structure/settling_samples", u64::MAX.into()),
        ("/structure/frequencies", 20.into()),
        ("/structure/noise_order", 2.into()),
        ("/structure/noise_order", u64::MAX.into()),
        ("/theta", serde_json::json!([1.0])),
        ("/covariance/3", serde_json::json!([])),
        ("/step/sd", serde_json::json!([])),
        ("/step/pointwise/level", 1.0.into()),
        ("/step/truncation_bias", (-1.0).into()),
        ("/sample_period_s", 0.0.into()),
        ("/sample_period_s", 1e300.into()),
    ];
    for (place, value) in changes {
        let mut file = golden();
        *file.pointer_mut(place).expect(place) = value.clone();
        let said = refused(&file);
        assert!(
            said.contains("contradicts itself"),
            "{place} {value}: {said}"
        );
    }
}

/// Everything that is done with a model from a file.
fn use_model(text: &str) {
    let Ok(model) = read(text) else { return };
    let flight = parse_flight_model(text, Path::new("m.json")).ok().flatten();
    let export = Export::new(
        "m",
        "m.json",
        &model,
        flight,
        ModelMetadata::in_model_file(text),
    );
    for target in Target::ALL {
        let _some_have_no_form = export.write(target);
    }
    assert!(!summary::of_model("m", &model, summary::Units::default()).is_empty());
    let input: Vec<f64> = (0..100).map(|k| f64::from(k / 7 % 2)).collect();
    if let Ok(record) = Record::from_slices(model.sample_period_s, &input, &input) {
        let _may_not_apply = model.validate(&record);
    }
    let other = read(&GOLDEN).unwrap();
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
            paper: &[],
        });
        if let Some(found) = found {
            let _ = summary::of_comparison("a", "b", &found);
            let _ = svg::draw(&difference("m", "m", "a", "b", &found));
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
        cases: 200,
        rng_seed: RngSeed::Fixed(1),
        failure_persistence: None,
        ..ProptestConfig::default()
    })]
    /// Numbers that no servo has, wherever a number is: refused, or worked with.
    #[test]
    fn nearly_a_model(
        places in prop::collection::vec(any::<prop::sample::Index>(), 1..4),
        number in prop::sample::select(vec![
            "0", "-1", "1", "3", "5000", "4294967296", "18446744073709551615",
            "1e-300", "-1e-75", "1e75", "-1e75", "1e300", "-1e308", "0.5", "null",
        ]),
    ) {
        let mut text = GOLDEN.clone();
        for place in places {
            let numbers = numbers(&text);
            text.replace_range(numbers[place.index(numbers.len())].clone(), number);
        }
        use_model(&text);
    }
}
