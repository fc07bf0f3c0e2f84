//! Recordings: files, tables in memory, and arrays.

use crate::arguments::in_python;
use crate::arrays::{ArrayColumns, ArrayOptions};
use crate::compute::compute;
use crate::error::raised;
use numpy::PyArray1;
use pyo3::prelude::*;
use servoid::data::dataset::{self, Dataset, DatasetOptions, TimeUnit};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A data set, and how it was read.
pub(crate) struct Source {
    pub(crate) dataset: Dataset<'static>,
    pub(crate) name: String,
    pub(crate) read_as: DatasetOptions,
}

/// The runs of one servo under one condition.
#[pyclass(frozen, module = "servoid._servoid")]
pub(crate) struct Data(pub(crate) Arc<Source>);

/// How to read files of other programs: the options of the command line.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct ReadOptions {
    input: Option<String>,
    output: Option<String>,
    period: Option<f64>,
    time: Option<String>,
    time_unit: Option<String>,
    run: Option<String>,
    controller: Option<String>,
    at_rest: Option<f64>,
    polled: bool,
    exact_command: bool,
    with_rest: bool,
}

impl ReadOptions {
    pub(crate) fn parsed(self) -> PyResult<DatasetOptions> {
        let unit = |symbol: &String| {
            TimeUnit::of_symbol(symbol).ok_or_else(|| {
                raised(anyhow::anyhow!(
                    "{symbol:?} is no unit of time: choose s, ms, us or ns"
                ))
            })
        };
        Ok(DatasetOptions {
            time_unit: self.time_unit.as_ref().map(unit).transpose()?,
            input: self.input,
            output: self.output,
            period_s: self.period,
            time: self.time,
            run: self.run,
            controller: self.controller,
            at_rest: self.at_rest,
            polled: self.polled,
            exact_command: self.exact_command,
            with_rest: self.with_rest,
        })
    }
}

impl Data {
    fn of(dataset: Dataset<'static>, name: String, read_as: DatasetOptions) -> Self {
        Self(Arc::new(Source {
            dataset,
            name,
            read_as,
        }))
    }
}

type Columns<'py> = (Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<f64>>);

#[pymethods]
impl Data {
    /// The runs of these files together.
    #[staticmethod]
    fn read(py: Python<'_>, paths: Vec<PathBuf>, options: ReadOptions) -> PyResult<Self> {
        let options = options.parsed()?;
        compute(py, move |_| {
            let dataset = dataset::load(&paths, &options)?;
            Ok(Self::of(dataset, dataset::listed(&paths), options))
        })
    }

    /// The runs of these files, read as those of a model were, where the options leave it open.
    #[staticmethod]
    fn read_as(
        py: Python<'_>,
        paths: Vec<PathBuf>,
        options: ReadOptions,
        model: &crate::model::Model,
    ) -> PyResult<Self> {
        let options = options.parsed()?;
        let like = model.file.read_as.clone();
        compute(py, move |_| {
            let dataset = dataset::load_as(&paths, &options, &like)?;
            Ok(Self::of(dataset, dataset::listed(&paths), options))
        })
    }

    /// The runs of a table in CSV.
    #[staticmethod]
    fn of_table(
        py: Python<'_>,
        table: Vec<u8>,
        name: String,
        options: ReadOptions,
    ) -> PyResult<Self> {
        let options = options.parsed()?;
        compute(py, move |_| {
            let dataset = dataset::of_bytes(table, Path::new(&name), &options)?;
            Ok(Self::of(dataset, name, options))
        })
    }

    /// Arrays of samples, copied: the data outlive the call, and do not change with the arrays of the caller.
    #[staticmethod]
    fn of_arrays(
        py: Python<'_>,
        runs: Vec<ArrayColumns<'_>>,
        name: String,
        options: ArrayOptions,
    ) -> PyResult<Self> {
        let arrays = options.with_runs(&name, &runs).into_owned();
        let dataset = py.detach(|| dataset::of_arrays(arrays)).map_err(raised)?;
        Ok(Self::of(dataset, name, DatasetOptions::default()))
    }

    /// What the data are called.
    #[getter]
    fn name(&self) -> &str {
        &self.0.name
    }

    /// Time between samples (s).
    #[getter]
    fn sample_period_s(&self) -> f64 {
        self.0.dataset.record.sample_period_s()
    }

    /// From an edge of the input to the first sample that carries it (s).
    #[getter]
    fn sample_phase_s(&self) -> f64 {
        self.0.dataset.record.sample_phase_s()
    }

    /// Number of samples of all runs, and of those that are missing.
    #[getter]
    fn samples(&self) -> (usize, usize) {
        let record = &self.0.dataset.record;
        (record.samples(), record.missing())
    }

    /// Units of input and output, where they are known.
    #[getter]
    fn units(&self) -> (Option<&str>, Option<&str>) {
        let about = &self.0.dataset.about;
        (about.input_unit.as_deref(), about.output_unit.as_deref())
    }

    /// What a user should know about the files.
    #[getter]
    fn remarks(&self) -> Vec<String> {
        let remarks = self.0.dataset.about.remarks.iter();
        remarks.map(|remark| in_python(remark)).collect()
    }

    /// Input and output of each run.
    fn runs<'py>(&self, py: Python<'py>) -> Vec<Columns<'py>> {
        let runs = self.0.dataset.record.runs().iter();
        let columns =
            runs.map(|run| [run.input(), run.output()].map(|c| PyArray1::from_slice(py, c)));
        columns.map(|[input, output]| (input, output)).collect()
    }
}
