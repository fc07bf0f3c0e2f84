//! Identification.

use crate::arrays::{ArrayColumns, ArrayOptions};
use crate::compute::{Interrupted, compute, compute_borrowed};
use crate::data::Data;
use crate::error::raised;
use crate::model::Model;
use pyo3::prelude::*;
use servoid::analysis::{Identified, IdentifyRequest, ServoModelSearch, to_json};
use servoid::data::dataset::{self, Dataset, DatasetOptions};
use servoid_identification::Options;

/// The options of `servoid identify`, as texts where it takes words.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct IdentifyOptions {
    settling: String,
    frequencies: String,
    noise_order: String,
    detrend: String,
    prior: String,
    level: f64,
    explain: bool,
    flight_model: bool,
    servo_model: Option<bool>,
    limits: bool,
}

impl IdentifyOptions {
    fn request(&self) -> PyResult<IdentifyRequest> {
        let options = Options {
            settling: self.settling.parse().map_err(raised)?,
            frequencies: self.frequencies.parse().map_err(raised)?,
            noise_order: self.noise_order.parse().map_err(raised)?,
            detrend: self.detrend.parse().map_err(raised)?,
            prior: self.prior.parse().map_err(raised)?,
            level: self.level,
            ..Options::default()
        };
        options.check().map_err(raised)?;
        Ok(IdentifyRequest {
            options,
            explain: self.explain,
            flight_model: self.flight_model,
            servo_model: ServoModelSearch::asked(self.servo_model),
            limits: self.limits,
            held_out: false,
        })
    }
}

/// The model of data.
#[pyfunction]
pub(crate) fn identify(
    py: Python<'_>,
    data: &Bound<'_, Data>,
    options: IdentifyOptions,
) -> PyResult<Model> {
    let source = data.get().0.clone();
    let request = options.request()?;
    compute(py, move |interrupted| {
        let (data, read_as) = (&source.dataset, source.read_as.clone());
        identified(data, &source.name, read_as, &request, interrupted)
    })
}

/// The model of arrays. Arrays of the caller are read where they are.
#[pyfunction]
pub(crate) fn identify_arrays(
    py: Python<'_>,
    runs: Vec<ArrayColumns<'_>>,
    name: String,
    arrays: ArrayOptions,
    options: IdentifyOptions,
) -> PyResult<Model> {
    let request = options.request()?;
    let arrays = arrays.with_runs(&name, &runs);
    compute_borrowed(py, |interrupted| {
        let data = dataset::of_arrays(arrays)?;
        identified(
            &data,
            &name,
            DatasetOptions::default(),
            &request,
            interrupted,
        )
    })
}

fn identified(
    data: &Dataset,
    name: &str,
    read_as: DatasetOptions,
    request: &IdentifyRequest,
    interrupted: Interrupted,
) -> anyhow::Result<Model> {
    let found = Identified::of(data, name, request, || interrupted)?;
    let document = to_json(&found.document(data, read_as))?;
    let summary = found.as_text(data, name, false);
    Model::of(document, name.to_owned(), Some(summary))
}
