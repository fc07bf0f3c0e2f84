//! The runs of files, as they are put together.

use super::about::About;
use super::error::{DatasetError, DatasetFault};
use crate::data::file_error::FileError;
use crate::data::mixed_units::advice_on_units;
use crate::data::model_metadata::ModelMetadata;
use servoid_identification::{Error, Run};
use std::borrow::Cow;
use std::path::{Path, PathBuf};

/// Periods that differ by less are the same: it is far below what any result resolves, and above
/// the rounding of times that are written with a few decimals.
const PERIOD_TOLERANCE: f64 = 1e-3;

/// Without any file there are no runs, which a record refuses.
#[derive(Default)]
pub(super) struct Loaded<'a> {
    pub(super) runs: Vec<Run<'a>>,
    /// What the controller of each run is called; empty where no column says it.
    pub(super) controllers: Vec<f64>,
    /// What was recorded around them while the input stood still.
    pub(super) rest: Vec<Run<'a>>,
    pub(super) period_s: f64,
    /// From a change of the input to the first sample that carries it (s).
    pub(super) phase_s: f64,
    pub(super) about: About,
}

/// By how much changes of a command that another clock `polled` are seen late on the mean (s): one that is seen in a row came up to one row before.
pub(super) fn late_by_polling(polled: bool, period_s: f64) -> f64 {
    match polled {
        true => 0.5 * period_s,
        false => 0.0,
    }
}

impl Loaded<'_> {
    /// Adds the runs of `next`, which is the file `path`; these are of the files `earlier`.
    pub(super) fn append(
        &mut self,
        next: Self,
        earlier: &[PathBuf],
        path: &Path,
    ) -> Result<(), DatasetError> {
        let refused = |fault| Err(FileError::at(path)(fault).into());
        if (next.period_s / self.period_s - 1.0).abs() > PERIOD_TOLERANCE {
            return refused(DatasetFault::MixedPeriods {
                found: next.period_s,
                expected: self.period_s,
            });
        }
        if next.phase_s != self.phase_s {
            return refused(DatasetFault::MixedPhases {
                found: next.phase_s,
                expected: self.phase_s,
            });
        }
        let [own, another] = [&self.about, &next.about].map(ModelMetadata::from);
        let (names, name) = (listed(earlier), path.display().to_string());
        own.same_units(&names, &another, &name)?;
        if own.units().output.is_none()
            && let Some(advice) = advice_on_units([&names, &name], [&self.runs, &next.runs])
        {
            self.about.remarks.push(advice.finding.clone());
            self.about.advice.push(advice);
        }
        self.runs.extend(next.runs);
        self.controllers.extend(next.controllers);
        self.rest.extend(next.rest);
        self.about.merge(next.about);
        Ok(())
    }
}

/// A run of these columns.
pub(super) fn run<'a>(
    input: impl Into<Cow<'a, [f64]>>,
    output: impl Into<Cow<'a, [f64]>>,
    at_rest: Option<f64>,
) -> Result<Run<'a>, Error> {
    let run = Run::new(input, output)?;
    Ok(match at_rest {
        Some(input) => run.with_input_at_rest(input),
        None => run,
    })
}

/// "a.csv, b.csv" for sentences.
#[must_use]
pub fn listed(paths: &[PathBuf]) -> String {
    let names: Vec<_> = paths.iter().map(|p| p.display().to_string()).collect();
    names.join(", ")
}
