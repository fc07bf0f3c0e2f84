//! Identification.

use crate::compute::compute;
use crate::data::Data;
use crate::error::raised;
use crate::model::Model;
use pyo3::prelude::*;
use servoid::analysis::{Identified, IdentifyRequest, to_json};
use servoid_identification::Options;

/// The options of `servoid identify`, as texts where it takes words.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct IdentifyOptions {
    settling: String,
    frequencies: String,
    noise_order: String,
    detrend: String,
    level: f64,
    explain: bool,
    flight_model: bool,
    servo_model: bool,
    limits: bool,
}

impl IdentifyOptions {
    fn request(&self) -> PyResult<IdentifyRequest> {
        let options = Options {
            settling: self.settling.parse().map_err(raised)?,
            frequencies: self.frequencies.parse().map_err(raised)?,
            noise_order: self.noise_order.parse().map_err(raised)?,
            detrend: self.detrend.parse().map_err(raised)?,
            level: self.level,
            ..Options::default()
        };
        options.check().map_err(raised)?;
        Ok(IdentifyRequest {
            options,
            explain: self.explain,
            flight_model: self.flight_model,
            servo_model: self.servo_model,
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
        let (data, name) = (&source.dataset, &source.name);
        let found = Identified::of(data, name, &request, || interrupted)?;
        let document = to_json(&found.document(data, source.read_as.clone()))?;
        let summary = found.as_text(data, name, false);
        Model::of(document, name.clone(), Some(summary))
    })
}
