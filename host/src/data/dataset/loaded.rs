//! The runs of files, as they are put together.

use super::about::About;
use super::error::DatasetError;
use crate::data::model_metadata::ModelMetadata;
use servoid_identification::Run;
use std::path::{Path, PathBuf};

/// Periods that differ by less are the same: it is far below what any result resolves, and above
/// the rounding of times that are written with a few decimals.
const PERIOD_TOLERANCE: f64 = 1e-3;

/// Without any file there are no runs, which a record refuses.
#[derive(Default)]
pub(super) struct Loaded {
    pub(super) runs: Vec<Run>,
    /// What was recorded around them while the input stood still.
    pub(super) rest: Vec<Run>,
    pub(super) period_s: f64,
    /// From a change of the input to the first sample that carries it (s).
    pub(super) phase_s: f64,
    pub(super) about: About,
}

impl Loaded {
    /// Adds the runs of `next`, which is the file `path`; these are of the files `earlier`.
    pub(super) fn append(
        &mut self,
        next: Self,
        earlier: &[PathBuf],
        path: &Path,
    ) -> Result<(), DatasetError> {
        if (next.period_s / self.period_s - 1.0).abs() > PERIOD_TOLERANCE {
            return Err(DatasetError::MixedPeriods {
                path: path.to_owned(),
                found: next.period_s,
                expected: self.period_s,
            });
        }
        if next.phase_s != self.phase_s {
            return Err(DatasetError::MixedPhases {
                path: path.to_owned(),
                found: next.phase_s,
                expected: self.phase_s,
            });
        }
        let (own, another) = (
            ModelMetadata::from(&self.about),
            ModelMetadata::from(&next.about),
        );
        own.same_units(&listed(earlier), &another, &path.display().to_string())?;
        self.runs.extend(next.runs);
        self.rest.extend(next.rest);
        self.about.merge(next.about);
        Ok(())
    }
}

/// A run of these columns, which are those of the file `path`.
pub(super) fn run(
    input: Vec<f64>,
    output: Vec<f64>,
    path: &Path,
    at_rest: Option<f64>,
) -> Result<Run, DatasetError> {
    let files = path.display().to_string();
    let run = Run::new(input, output).map_err(|error| DatasetError::Data { files, error })?;
    Ok(match at_rest {
        Some(input) => run.with_input_at_rest(input),
        None => run,
    })
}

/// "a.csv, b.csv" for sentences.
pub(crate) fn listed(paths: &[PathBuf]) -> String {
    let names: Vec<_> = paths.iter().map(|p| p.display().to_string()).collect();
    names.join(", ")
}
