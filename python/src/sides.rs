//! Comparison and validation: the document, and the text that the program prints.

use crate::compute::compute;
use crate::data::Data;
use crate::error::raised;
use crate::model::Model;
use pyo3::prelude::*;
use servoid::analysis::{Compared, ServoModelSearch, Validated, to_json};
use servoid_identification::Options;
use servoid_identification::comparison::ComparisonOptions;

/// The options of `servoid compare`.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct CompareOptions {
    margin: f64,
    level: f64,
    zero_sd: f64,
    servo_model: Option<bool>,
}

impl CompareOptions {
    fn parsed(&self) -> PyResult<ComparisonOptions> {
        let identification = Options {
            level: self.level,
            ..Options::default()
        };
        identification.check().map_err(raised)?;
        for (name, value) in [("margin", self.margin), ("zero_sd", self.zero_sd)] {
            if !(value >= 0.0 && value.is_finite()) {
                return Err(raised(anyhow::anyhow!(
                    "{name} must be 0 or more, not {value}"
                )));
            }
        }
        Ok(ComparisonOptions {
            margin_percent: self.margin,
            identification,
            zero_sd: self.zero_sd,
            ..ComparisonOptions::default()
        })
    }
}

/// Compares recordings.
#[pyfunction]
pub(crate) fn compare(
    py: Python<'_>,
    a: &Bound<'_, Data>,
    b: &Bound<'_, Data>,
    options: CompareOptions,
) -> PyResult<(String, String)> {
    let [a, b] = [a, b].map(|side| side.get().0.clone());
    let search = ServoModelSearch::asked(options.servo_model);
    let parsed = options.parsed()?;
    compute(py, move |interrupted| {
        let (sides, names) = ([&a.dataset, &b.dataset], [a.name.as_str(), b.name.as_str()]);
        let found = Compared::recordings(sides, names, parsed, search, || interrupted)?;
        Ok((to_json(&found)?, found.as_text(names)))
    })
}

/// Compares models.
#[pyfunction]
pub(crate) fn compare_models(
    a: &Model,
    b: &Model,
    options: CompareOptions,
) -> PyResult<(String, String)> {
    let (files, names) = ([&a.file, &b.file], [a.name.as_str(), b.name.as_str()]);
    let options_of_all = options.parsed()?;
    let search = ServoModelSearch::asked(options.servo_model);
    let found = Compared::models(files, names, &options_of_all, search);
    let found = found.map_err(raised)?;
    Ok((to_json(&found).map_err(raised)?, found.as_text(names)))
}

/// Validates a model on data.
#[pyfunction]
pub(crate) fn validate(
    py: Python<'_>,
    model: &Model,
    data: &Bound<'_, Data>,
    frame_ms: Option<f64>,
) -> PyResult<(String, String)> {
    let source = data.get().0.clone();
    let of = || -> anyhow::Result<(String, String)> {
        let data = &source.dataset;
        let found = Validated::of(&model.file, &model.name, data, &source.name, frame_ms)?;
        let unit = data.about.output_unit.as_deref();
        let text = found.as_text(unit);
        Ok((to_json(&found)?, text))
    };
    py.detach(of).map_err(raised)
}
