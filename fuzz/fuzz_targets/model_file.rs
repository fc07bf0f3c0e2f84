//! Any text as a model's file: what is read can be exported, compared, validated and put on a page.
#![no_main]

use libfuzzer_sys::fuzz_target;
use servoid::export::{Export, Target};
use servoid::model_metadata::ModelMetadata;
use servoid::report::{self, Page, Servo};
use servoid::{output, plots, summary};
use servoid_identification::Record;
use servoid_identification::comparison::{ComparisonOptions, compare_models};
use servoid_identification::model::Model;
use std::path::Path;
use std::sync::LazyLock;

/// A model to compare with: a file that is in the corpus.
static OTHER: LazyLock<Model> = LazyLock::new(|| {
    let text = include_str!("../corpus/model_file/lag.json");
    output::parse_model(text, Path::new("lag.json")).expect("it is a model")
});

fuzz_target!(|text: &str| {
    let path = Path::new("x.json");
    let Ok(model) = output::parse_model(text, path) else { return };
    let flight = output::parse_flight_model(text, path).ok().flatten();
    let export = Export::new("x", "x.json", &model, flight, ModelMetadata::in_model_file(text));
    for target in Target::ALL {
        let _ = export.write(target);
    }
    let _ = export.warnings();
    assert!(!summary::of_model("x", &model, summary::Units::default()).is_empty());

    let input: Vec<f64> = (0..200).map(|k| f64::from(k / 7 % 2)).collect();
    let record = Record::from_slices(model.sample_period_s, &input, &input);
    if let Ok(found) = record.and_then(|record| model.validate(&record)) {
        let _ = summary::of_validation(&found, None, &model.advice);
    }
    for (a, b) in [(&*OTHER, &model), (&model, &*OTHER), (&model, &model)] {
        let found = compare_models(a, b, &ComparisonOptions::default());
        let first = Servo::of_model("a".into(), a.clone(), ModelMetadata::in_model_file(text));
        let second = Servo::of_model("b".into(), b.clone(), ModelMetadata::default());
        let page = report::page(&Page {
            title: "x",
            first: first.part(),
            second: Some(second.part()),
            comparison: found.as_ref().ok(),
            paper: &[],
        });
        // A number that grew beyond all bounds has no form in JSON.
        let _ = page;
        if let Ok(found) = found {
            let _ = summary::of_comparison("a", "b", &found);
            let _ = plots::svg::draw(&plots::difference::difference("x", "x", "a", "b", &found));
        }
    }
});
