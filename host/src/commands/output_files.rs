//! Files that commands write: never over an existing one without `--force`.

use crate::data::recording::{WholeFile, WriteError};
use crate::presentation::plots::{Figure, svg};
use anyhow::{Context, Result, bail};
use servoid_identification::Model;
use servoid_identification::comparison::Comparison;
use servoid_identification::flight_model::FlightModel;
use servoid_identification::model::SCHEMA;
use std::io::Write;
use std::path::{Path, PathBuf};

/// Writes a file whole, or leaves the old one as it was. `force` allows to replace an existing file.
///
/// # Errors
/// One sentence: it exists, or the error of the system.
pub fn write_file(path: &Path, force: bool, content: &str) -> Result<()> {
    let whole = WholeFile::new(path, force)?;
    let written = whole.file()?.write_all(content.as_bytes());
    written.map_err(|reason| WriteError::NotCreated {
        path: path.to_owned(),
        reason,
    })?;
    Ok(whole.put_in_place()?)
}

/// Checks before the work that `path` can be written after it.
///
/// # Errors
/// [`WriteError::Exists`].
pub fn check_free(path: &Path, force: bool) -> Result<()> {
    if !force && path.exists() {
        return Err(WriteError::exists(path).into());
    }
    Ok(())
}

/// Draws figures into a folder, which is created if it does not exist; returns the files.
///
/// # Errors
/// One sentence.
pub fn write_figures(folder: &Path, force: bool, figures: &[Figure]) -> Result<Vec<PathBuf>> {
    std::fs::create_dir_all(folder)
        .with_context(|| format!("the folder {folder:?} cannot be created"))?;
    let mut files = Vec::new();
    for figure in figures {
        let path = folder.join(format!("{}.svg", figure.name));
        let drawing = svg::draw(figure)
            .map_err(|e| anyhow::anyhow!("the plot {:?} cannot be drawn: {e}", figure.name))?;
        write_file(&path, force, &drawing)?;
        files.push(path);
    }
    Ok(files)
}

/// Reads a model that `servoid identify` has written.
///
/// # Errors
/// One sentence: it cannot be read, is no model, or was made by a newer servoid.
pub fn read_model(path: &Path) -> Result<Model> {
    parse_model(&read_text(path)?, path)
}

/// [`read_model`] of a text; errors call it `path`.
///
/// # Errors
/// As [`read_model`].
pub fn parse_model(text: &str, path: &Path) -> Result<Model> {
    if let Ok(SchemaOnly { schema }) = serde_json::from_str(text)
        && schema != SCHEMA
    {
        let number = match &schema {
            serde_json::Value::String(text) => text.trim().parse().ok(),
            other => other.as_f64(),
        };
        match number {
            Some(number) if number > f64::from(SCHEMA) => bail!(
                "the model {path:?} was made by a newer servoid (schema {schema}, this one reads up to {SCHEMA}): update servoid"
            ),
            _ => bail!(
                "the model {path:?} has the schema {schema}, which no servoid writes (this one writes {SCHEMA}): identify again"
            ),
        }
    }
    if !text.trim_start().starts_with('{') {
        bail!(
            "{path:?} is no model: identify the recording first, with servoid identify RECORDING.csv -o MODEL.json"
        );
    }
    let model: Model = serde_json::from_str(text)
        .map_err(|e| anyhow::anyhow!("{path:?} is no model of 'servoid identify': {e}"))?;
    if !model.is_consistent() {
        bail!(
            "the model {path:?} contradicts itself: its lists do not have the lengths that its structure says, or its numbers are beyond what any servo could have; identify again"
        );
    }
    Ok(model)
}

/// Reads the model of low order that a model's file may carry beside the model.
///
/// # Errors
/// One sentence: it cannot be read, or it contradicts itself.
pub fn read_flight_model(path: &Path) -> Result<Option<FlightModel>> {
    parse_flight_model(&read_text(path)?, path)
}

/// [`read_flight_model`] of a text; errors call it `path`.
///
/// # Errors
/// As [`read_flight_model`].
pub fn parse_flight_model(text: &str, path: &Path) -> Result<Option<FlightModel>> {
    let beside: Beside = serde_json::from_str(text)
        .map_err(|e| anyhow::anyhow!("the low-order model in {path:?} cannot be read: {e}"))?;
    if beside
        .flight_model
        .as_ref()
        .is_some_and(|flight| !flight.is_consistent())
    {
        bail!("the low-order model in {path:?} contradicts itself: identify again");
    }
    Ok(beside.flight_model)
}

/// The text of a model file.
///
/// # Errors
/// One sentence: what the system said.
pub fn read_text(path: &Path) -> Result<String> {
    let bytes = crate::data::input_file::read(path)
        .map_err(|reason| anyhow::anyhow!("the model {path:?} cannot be read: {reason}"))?;
    String::from_utf8(bytes).map_err(|_| anyhow::anyhow!("the model {path:?} is not text"))
}

/// What may stand beside a model in its file.
#[derive(serde::Deserialize)]
struct Beside {
    flight_model: Option<FlightModel>,
}

/// The one field that every version of the model has.
#[derive(serde::Deserialize)]
struct SchemaOnly {
    schema: serde_json::Value,
}

/// Takes out of a comparison whose bounds do not hold what would be read as one: NaN stands in its place, for
/// which JSON has `null`.
pub fn withhold_bounds(found: &mut Comparison) {
    if found.bounds_hold {
        return;
    }
    let difference = &mut found.difference_percent;
    for bound in [
        &mut difference.at_least,
        &mut difference.at_most,
        &mut difference.at_s,
    ] {
        *bound = f64::NAN;
    }
    for curve in &mut found.curves {
        curve.lower.fill(f64::NAN);
        curve.upper.fill(f64::NAN);
    }
}

/// A result as indented JSON with a final line end.
///
/// # Errors
/// When a value has no form in JSON.
pub fn to_json(value: &impl serde::Serialize) -> Result<String> {
    Ok(serde_json::to_string_pretty(value).context("the result cannot be written as JSON")? + "\n")
}
