//! One page with all results: first the verdict with its picture and six numbers, then words, advice, tables, figures to zoom
//! in, and the origin of the data. It needs no network, no server and no other file.
//!
//! A page has at most 8 MB: 1 for the plotting library, up to 1 for models, the rest for figures,
//! whose long signals are thinned out and of whose runs only the first are drawn.

mod answer;
mod content;
mod figures;
mod interactive;
mod servo;
mod servo_model;
mod text;

pub use super::paper_values::Fact;
pub use content::{Facts, Page, Part};
pub use servo::Servo;

use super::template::fill;
use crate::data::model_file::ModelDocument;
use anyhow::Result;
use serde_json::Value;
use text::{escape, json_in_page};

/// Title of a page without one of its own.
pub const TITLE: &str = "How the servo moves";

/// The page without its content.
const PAGE: &str = include_str!("page.html");

/// The page as HTML.
///
/// # Errors
/// When a number has no form in JSON.
pub fn page(page: &Page<'_>) -> Result<String> {
    let (first, figures) = (answer::picture(page), figures::all(page));
    let drawn: Vec<_> = std::iter::once(&first)
        .chain(figures.iter().map(|shown| &shown.figure))
        .map(interactive::plotly_json)
        .collect();
    let (models, remark) = models_in_page(page)?;
    let body = [
        answer::screen(page),
        text::words(page),
        text::advice(page),
        servo_model::tables(page),
        text::numbers(page),
        figures::places(&figures),
        text::structure(page),
        text::provenance(page),
        format!("<p class=\"faint\">{remark}</p>\n"),
    ];
    let made_by = format!(
        "servoid {}. Bounds of the responses are those of a linear servo: they cover noise and, from three runs on, what changes from run to run, not a servo that saturates. They need a command that was planned, not one that was computed from the measured motion.",
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
            servo_model: part.servo_model,
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
