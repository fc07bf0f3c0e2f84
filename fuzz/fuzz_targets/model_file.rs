//! Any text as a model's file: a model that is read can be exported, compared, validated and reported.
#![no_main]

use libfuzzer_sys::fuzz_target;
use servoid::presentation::export::{Export, Target};
use servoid::data::ModelMetadata;
use servoid::presentation::report::{self, Page, Servo};
use servoid::data::model_file::ModelFile;
use servoid::presentation::{plots, summary};
use servoid_identification::Record;
use servoid_identification::comparison::{ComparisonOptions, compare_models};
use servoid_identification::results::Model;
use std::path::Path;
use std::sync::LazyLock;

/// A model to compare with: a file that is in the corpus.
static OTHER: LazyLock<Model> = LazyLock::new(|| {
    let text = include_str!("../corpus/model_file/lag.json");
    let file = ModelFile::parse(text, Path::new("lag.json"));
    file.expect("it is a model").model
});

fuzz_target!(|text: &str| {
    let Ok(file) = ModelFile::parse(text, Path::new("x.json")) else { return };
    let flight = file.flight_model().ok().flatten();
    let ModelFile { model, metadata, .. } = file;
    let export = Export::new("x", "x.json", &model, flight, metadata.clone());
    for target in Target::ALL {
        let _ = export.write(target);
    }
    let _ = export.warnings();
    let extent = summary::Extent { of_servo: "", low_order: None, picture: "", statistics: true, machine_is_not_linear: true };
    assert!(!summary::of_model("x", &model, &metadata, extent).is_empty());

    let input: Vec<f64> = (0..200).map(|k| f64::from(k / 7 % 2)).collect();
    let record = Record::of_run(model.sample_period_s, &input, &input);
    if let Ok(found) = record.and_then(|record| model.validate(&record)) {
        let _ = summary::of_validation(Some(&found), None, (model.fit.simulation_percent, None), None);
    }
    for (a, b) in [(&*OTHER, &model), (&model, &*OTHER), (&model, &model)] {
        let found = compare_models(a, b, &ComparisonOptions::default());
        let first = Servo::of_model("a".into(), a.clone(), metadata.clone());
        let second = Servo::of_model("b".into(), b.clone(), ModelMetadata::default());
        let page = report::page(&Page {
            title: "x",
            first: first.part(),
            second: Some(second.part()),
            comparison: found.as_ref().ok(),
            servo_models: None,
            paper: &[],
        });
        // A number that grew beyond all bounds has no form in JSON.
        let _ = page;
        if let Ok(found) = found {
            let _ = summary::of_comparison(&found, metadata.units());
            let _ = plots::draw(&plots::difference("x", "x", "a", "b", &found));
        }
    }
});
