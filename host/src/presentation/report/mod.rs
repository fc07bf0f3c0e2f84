//! One page with all results: the verdict, the metrics with their intervals, the advice, the paper's figures to
//! zoom in, and the origin of the data. It needs no network, no server and no other file.
//!
//! A page has at most 8 MB: 1 for the plotting library, up to 1 for models, the rest for figures,
//! whose long signals are thinned out and of whose runs only the first are drawn.

mod figures;
mod interactive;
mod servo;
mod text;

pub use super::paper_values::Fact;
pub use servo::Servo;

use super::plots::Subject;
use super::template::fill;
use crate::data::model_file::ModelDocument;
use crate::data::model_metadata::ModelMetadata;
use anyhow::Result;
use serde_json::Value;
use servoid_identification::comparison::Comparison;
use servoid_identification::diagnostics::Explanation;
use servoid_identification::results::Model;
use text::{escape, json_in_page};

/// Names and values of what is known of one file.
pub type Facts = Vec<(String, String)>;

/// One servo in the report.
#[derive(Clone, Copy, Debug)]
pub struct Part<'a> {
    /// Model, and record where there is one.
    pub subject: Subject<'a>,
    /// The choice of the model's structure, where that is known.
    pub explanation: Option<&'a Explanation>,
    /// Models of its runs, each identified on its own, where there are several.
    pub runs: &'a [Model],
    /// Units, and the hold of the command.
    pub metadata: &'a ModelMetadata,
    /// The origin of the data, file by file.
    pub provenance: &'a [Facts],
}

/// The content of a page: one servo, or two and their comparison.
#[derive(Clone, Copy, Debug)]
pub struct Page<'a> {
    /// Its title.
    pub title: &'a str,
    /// The servo, or the reference condition.
    pub first: Part<'a>,
    /// The other condition.
    pub second: Option<Part<'a>>,
    /// The comparison of the two.
    pub comparison: Option<&'a Comparison>,
    /// The paper's values beside those found here, where the servos are those of the paper.
    pub paper: &'a [Fact],
}

impl<'a> Page<'a> {
    /// The first servo, and the second where there is one.
    fn parts(&self) -> impl Iterator<Item = &Part<'a>> {
        std::iter::once(&self.first).chain(&self.second)
    }
}

/// The page without its content.
const PAGE: &str = include_str!("page.html");

/// The page as HTML.
///
/// # Errors
/// When a number has no form in JSON.
pub fn page(page: &Page<'_>) -> Result<String> {
    let figures = figures::all(page);
    let drawn: Vec<_> = figures
        .iter()
        .map(|shown| interactive::plotly_json(&shown.figure))
        .collect();
    let (models, remark) = models_in_page(page)?;
    let body = [
        text::verdict(page),
        text::numbers(page),
        text::advice(page),
        figures::places(&figures),
        text::structure(page),
        text::provenance(page),
        format!("<p class=\"faint\">{remark}</p>\n"),
    ];
    let made_by = format!(
        "servoid {}. Bounds are those of a linear servo: they cover noise, not a servo that changes from run to run or saturates.",
        env!("CARGO_PKG_VERSION")
    );
    let values: [(&str, &str); 6] = [
        ("title", &escape(page.title)),
        ("made_by", &escape(&made_by)),
        ("body", &body.concat()),
        ("figures", &json_in_page(&drawn)?),
        ("models", &models),
        ("library", &interactive::library()),
    ];
    Ok(fill(PAGE, &values))
}

/// Room for the models in the page, of the 8 MB that it may have (bytes).
const MODELS_BYTES: usize = 1_000_000;

/// The models as JSON, and a remark on them. Covariances of very long responses, which grow
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
        let remark = "The models are in this page as JSON, as 'servoid identify' writes them, in the element 'models'.";
        return Ok((whole, remark));
    }
    let mut values = serde_json::to_value(&models)?;
    for model in values.as_array_mut().into_iter().flatten() {
        if let Some(Value::Object(bounds)) = model.get_mut("bounds") {
            bounds.insert("covariance".to_owned(), Value::Null);
        }
    }
    let remark = "The models are in this page as JSON in the element 'models', without their covariance, which is too long here: 'servoid identify -o' writes it.";
    Ok((json_in_page(&values)?, remark))
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
