//! Arrays of the caller, read where they are.

use numpy::PyReadonlyArray1;
use pyo3::prelude::*;
use servoid::data::dataset::{ArrayRun, Arrays};
use std::borrow::Cow;

/// Runs as arrays, one entry of each list for each run.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct ArrayOptions {
    period: f64,
    phase: f64,
    at_rest: Vec<Option<f64>>,
    polled: bool,
    exact_command: bool,
    controllers: Vec<f64>,
    input_unit: Option<String>,
    output_unit: Option<String>,
}

/// Input and output of one run, as arrays of the caller.
pub(crate) type ArrayColumns<'py> = (PyReadonlyArray1<'py, f64>, PyReadonlyArray1<'py, f64>);

impl ArrayOptions {
    /// These runs, which are called `name`. Only arrays with gaps between their values are copied.
    pub(crate) fn with_runs<'a>(self, name: &str, runs: &'a [ArrayColumns<'_>]) -> Arrays<'a> {
        let runs = runs.iter().zip(self.at_rest);
        let runs = runs.map(|((input, output), at_rest)| ArrayRun {
            input: lent(input),
            output: lent(output),
            at_rest,
        });
        Arrays {
            name: name.to_owned(),
            period_s: self.period,
            phase_s: self.phase,
            runs: runs.collect(),
            polled: self.polled,
            exact_command: self.exact_command,
            controllers: self.controllers,
            input_unit: self.input_unit,
            output_unit: self.output_unit,
        }
    }
}

/// The values of an array, without a copy where they lie next to each other.
pub(crate) fn lent<'a>(array: &'a PyReadonlyArray1<'_, f64>) -> Cow<'a, [f64]> {
    match array.as_slice() {
        Ok(values) => values.into(),
        Err(_) => array.as_array().to_vec().into(),
    }
}
