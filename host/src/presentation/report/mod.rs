//! One page that holds everything: what was measured, the numbers with their intervals, the verdict,
//! the advice, and the paper's figures to zoom in. It needs no network, no server and no other file.
//!
//! A page has at most 8 MB: 4.7 for the plotting library, up to 1 for models, the rest for figures,
//! whose long signals are thinned out and of whose runs only the first are drawn.

mod figures;
mod interactive;
mod servo;
mod text;

pub use servo::Servo;

use crate::data::model_file::ModelDocument;
use crate::data::model_metadata::ModelMetadata;
use crate::presentation::paper_values::Fact;
use crate::presentation::plots::paper_figures::Subject;
use crate::presentation::template::fill;
use anyhow::Result;
use serde_json::Value;
use servoid_identification::comparison::Comparison;
use servoid_identification::{
    Explanation, Identification, Model, Options, Record, Settling, identify,
};
use std::fmt::Write;
use text::{escape, json_in_page};

/// The page around it all; `{{name}}` stands for what is put in.
const PAGE: &str = include_str!("page.html");

/// Name and value of each thing that is known about one file.
pub type Facts = Vec<(String, String)>;

/// One servo in the report.
#[derive(Clone, Copy, Debug)]
pub struct Part<'a> {
    /// Model, and record where there is one.
    pub subject: Subject<'a>,
    /// How the model came about, where that is known.
    pub explanation: Option<&'a Explanation>,
    /// Models of its runs, each identified on its own, where there are several.
    pub runs: &'a [Model],
    /// What is known of units and of what held the command.
    pub metadata: &'a ModelMetadata,
    /// Where the data come from, file by file.
    pub provenance: &'a [Facts],
}

/// What a page shows.
#[derive(Clone, Copy, Debug)]
pub struct Page<'a> {
    /// What it is called.
    pub title: &'a str,
    /// The servo, or the reference condition.
    pub first: Part<'a>,
    /// What it is held against.
    pub second: Option<Part<'a>>,
    /// The outcome of holding the two against each other.
    pub comparison: Option<&'a Comparison>,
    /// The paper's facts beside ours, where the servos are those of the paper.
    pub paper: &'a [Fact],
}

impl<'a> Page<'a> {
    fn parts(&self) -> impl Iterator<Item = &Part<'a>> {
        std::iter::once(&self.first).chain(&self.second)
    }
}

/// Most runs that are identified one by one.
const MOST_RUNS_ALONE: usize = 10;

/// Each run of a record identified on its own, with the settling time that all of them have together.
/// Nothing where there is one run, or one is too short for a model.
#[must_use]
fn runs_alone(record: &Record, found: &Identification) -> Vec<Model> {
    let runs = record.runs();
    if !(2..=MOST_RUNS_ALONE).contains(&runs.len()) {
        return Vec::new();
    }
    let default = Options::default();
    let options = Options {
        settling: Settling::Samples(found.model.structure.settling_samples),
        level: found.model.level().into_valid().unwrap_or(default.level),
        ..default
    };
    let alone = |run: &servoid_identification::Run| {
        let record = Record::new(record.sample_period_s(), vec![run.clone()])?;
        identify(
            &record.with_sample_phase(found.model.sample_phase_s),
            &options,
        )
    };
    let models: Result<Vec<Model>, _> = runs.iter().map(alone).collect();
    models.unwrap_or_default()
}

/// Makes the page.
///
/// # Errors
/// When a number has no form in JSON.
pub fn page(page: &Page<'_>) -> Result<String> {
    let figures = figures::all(page);
    let mut body = String::new();
    text::write_verdict(&mut body, page)?;
    text::write_numbers(&mut body, page)?;
    text::write_advice(&mut body, page)?;
    figures::write_places(&mut body, &figures)?;
    text::write_structure(&mut body, page)?;
    text::write_provenance(&mut body, page)?;
    let drawn: Vec<_> = figures
        .iter()
        .map(|shown| interactive::plotly_json(&shown.figure))
        .collect();
    let (models, remark) = models_in_page(page)?;
    writeln!(body, "<p class=\"faint\">{remark}</p>")?;
    let made_by = format!(
        "servoid {}. Bounds are those of a linear servo: they cover noise, not a servo that changes from run to run or saturates.",
        env!("CARGO_PKG_VERSION")
    );
    let values: [(&str, &str); 6] = [
        ("title", &escape(page.title)),
        ("made_by", &escape(&made_by)),
        ("body", &body),
        ("figures", &json_in_page(&drawn)?),
        ("models", &models),
        ("library", &interactive::library()),
    ];
    Ok(fill(PAGE, &values))
}

/// Room for the models in the page, of the 8 MB that it may have (bytes).
const MODELS_BYTES: usize = 1_000_000;

/// The models as JSON, and what the page says of them. Covariances of very long responses, which grow
/// with the square of their length, are left out.
fn models_in_page(page: &Page<'_>) -> Result<(String, &'static str)> {
    let models: Vec<ModelDocument<'_>> = page
        .parts()
        .map(|part| ModelDocument {
            model: part.subject.model,
            metadata: part.metadata.clone(),
            record: part.subject.record,
        })
        .collect();
    let whole = json_in_page(&models)?;
    if whole.len() <= MODELS_BYTES {
        return Ok((
            whole,
            "The models are in this page as JSON, as 'servoid identify' writes them, in the element 'models'.",
        ));
    }
    let mut values = serde_json::to_value(&models)?;
    for model in values.as_array_mut().into_iter().flatten() {
        if let Some(Value::Object(bounds)) = model.get_mut("bounds") {
            bounds.insert("covariance".to_owned(), Value::Null);
        }
    }
    Ok((
        json_in_page(&values)?,
        "The models are in this page as JSON in the element 'models', without their covariance, which is too long here: 'servoid identify -o' writes it.",
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_from_elsewhere_stay_texts() {
        let hostile = "</script><script>alert('x')</script>\"&{{library}}<!--<script>";
        assert!(!escape(hostile).contains('<'));
        assert!(!json_in_page(&[hostile]).unwrap().contains('<'));
        let values = [
            ("title", escape(hostile)),
            ("library", "THE LIBRARY".into()),
        ];
        let page = fill(PAGE, &values);
        assert_eq!(
            page.matches("THE LIBRARY").count(),
            1,
            "a value is never filled in again"
        );
        assert!(!page.contains("alert('x')"));
    }
}
