//! From files to a record: recordings of this program, or any CSV file with its columns named.
//!
//! Of a recording of this program only the reference is identified, not the rest at neutral around it,
//! which shows the noise of a servo that does not move and no more: the strokes from and to neutral are half
//! as long as those of the reference, and a servo does not answer half a stroke with half the motion. On the
//! simulated bench servo the rest made the model's error 2.6 times larger (0.128 against 0.050 degrees rms).

mod error;
mod from_recordings;
mod from_tables;
mod metadata;
mod sentinel_values;
pub(crate) mod suggestion;
mod time_column;

pub use error::DatasetError;
pub use time_column::TimeUnit;

use crate::data::fingerprint;
use crate::data::model_metadata::ModelMetadata;
use crate::data::recording::{self, Recording};
use crate::data::table::{Table, TableError};
use crate::data::units::Units;
use servoid_identification::advice::Advice;
use servoid_identification::{Record, Run};
use std::path::{Path, PathBuf};

/// How to read files that are not recordings of this program.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DatasetOptions {
    /// The column with the input.
    pub input: Option<String>,
    /// The column with the output.
    pub output: Option<String>,
    /// Time between rows (s).
    pub period_s: Option<f64>,
    /// The column of time; without it, one that is called like one.
    pub time: Option<String>,
    /// The unit of a column of time whose name does not say it.
    pub time_unit: Option<TimeUnit>,
    /// The column whose value changes where a new run begins.
    pub run: Option<String>,
    /// The input before the first row of each run.
    pub at_rest: Option<f64>,
    /// Use the rest around the reference too.
    pub with_rest: bool,
}

/// A record, and what is known of where it comes from.
#[derive(Clone, Debug)]
pub struct Dataset {
    /// The runs.
    pub record: Record,
    /// What the files say of themselves.
    pub about: About,
}

/// What files say of themselves.
#[derive(Clone, Debug, Default)]
pub struct About {
    /// Whether all files are recordings of servoid, whose command changes with the pulse frame only.
    pub by_servoid: bool,
    /// The unit of what was commanded, where the files say it and agree.
    pub input_unit: Option<String>,
    /// The unit of what was measured, where the files say it and agree.
    pub output_unit: Option<String>,
    /// Under what condition it was recorded, where the files say it and agree.
    pub condition: Option<String>,
    /// Where the data come from, file by file: name and value of each thing that is known.
    pub provenance: Vec<Vec<(String, String)>>,
    /// What a user should know about the files: partial recordings, guessed periods.
    pub remarks: Vec<String>,
    /// What every result from these files has to carry: that a recording is partial, or values of
    /// its header unproved.
    pub advice: Vec<Advice>,
}

impl About {
    /// The unit of the input of both, empty where they do not have one in common.
    #[must_use]
    pub fn input_unit_with(&self, other: &Self) -> String {
        in_common(self.input_unit.as_ref(), other.input_unit.as_ref())
    }

    /// The unit of the output of both, empty where they do not have one in common.
    #[must_use]
    pub fn output_unit_with(&self, other: &Self) -> String {
        in_common(self.output_unit.as_ref(), other.output_unit.as_ref())
    }

    /// The units of the two columns.
    #[must_use]
    pub fn units(&self) -> Units<'_> {
        Units {
            input: self.input_unit.as_deref(),
            output: self.output_unit.as_deref(),
        }
    }

    fn merge(&mut self, other: Self) {
        let agree = |mine: &mut Option<String>, theirs: Option<String>| {
            if *mine != theirs {
                *mine = None;
            }
        };
        self.by_servoid &= other.by_servoid;
        agree(&mut self.input_unit, other.input_unit);
        agree(&mut self.output_unit, other.output_unit);
        agree(&mut self.condition, other.condition);
        self.provenance.extend(other.provenance);
        self.remarks.extend(other.remarks);
        self.advice.extend(other.advice);
    }
}

/// Without any file there are no runs, which a record refuses.
#[derive(Default)]
struct Loaded {
    runs: Vec<Run>,
    /// What was recorded around them while the input stood still.
    rest: Vec<Run>,
    period_s: f64,
    /// From a change of the input to the first sample that carries it (s).
    phase_s: f64,
    about: About,
}

impl Loaded {
    /// Adds the runs of `next`, which is the file `path`; these are of the files `earlier`.
    fn append(&mut self, next: Self, earlier: &[PathBuf], path: &Path) -> Result<(), DatasetError> {
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

/// Reads files, each one run or more, into one record.
///
/// # Errors
/// [`DatasetError`].
pub fn load(paths: &[PathBuf], options: &DatasetOptions) -> Result<Dataset, DatasetError> {
    let mut all: Option<Loaded> = None;
    for (index, path) in paths.iter().enumerate() {
        // A run that counts twice would make bounds narrower than they are.
        let earlier = paths.get(..index).unwrap_or_default();
        if earlier.contains(path) {
            return Err(DatasetError::Twice { path: path.clone() });
        }
        let next = load_one(path, options)?;
        match &mut all {
            Some(all) => all.append(next, earlier, path)?,
            None => all = Some(next),
        }
    }
    let Loaded {
        runs,
        rest,
        period_s,
        phase_s,
        mut about,
    } = all.unwrap_or_default();
    let record = Record::new(period_s, runs).map_err(|error| DatasetError::Data {
        files: listed(paths),
        error,
    })?;
    if let Some(advice) = fingerprint::advice_on_repeats(&record) {
        about.remarks.push(advice.finding.clone());
        about.advice.push(advice);
    }
    Ok(Dataset {
        record: record.with_sample_phase(phase_s).with_rest(rest),
        about,
    })
}

/// Reads two sides that are to be held against each other. Where one side is recordings of servoid without
/// the columns that `options` name, and the other has them, `options` are how to read the other.
///
/// # Errors
/// [`DatasetError`].
pub fn load_sides(
    sides: [&[PathBuf]; 2],
    options: &DatasetOptions,
) -> Result<[Dataset; 2], DatasetError> {
    let as_recordings = |paths: &[PathBuf]| -> Result<Dataset, DatasetError> {
        let plain = DatasetOptions {
            with_rest: options.with_rest,
            ..DatasetOptions::default()
        };
        let mut side = load(paths, &plain)?;
        side.about.remarks.push(format!(
            "{} is read as the recording that it is; how to read columns was said for the other side",
            listed(paths)
        ));
        Ok(side)
    };
    match sides.map(|paths| load(paths, options)) {
        [Err(DatasetError::OtherColumns { .. }), Ok(b)] => Ok([as_recordings(sides[0])?, b]),
        [Ok(a), Err(DatasetError::OtherColumns { .. })] => Ok([a, as_recordings(sides[1])?]),
        // Columns were named for the other side, and that is where to look for the mistake.
        [Err(DatasetError::OtherColumns { .. }), Err(error)] => Err(error),
        [a, b] => Ok([a?, b?]),
    }
}

/// "a.csv, b.csv" for sentences.
pub(crate) fn listed(paths: &[PathBuf]) -> String {
    let names: Vec<_> = paths.iter().map(|p| p.display().to_string()).collect();
    names.join(", ")
}

fn in_common(a: Option<&String>, b: Option<&String>) -> String {
    a.filter(|unit| b == Some(unit))
        .cloned()
        .unwrap_or_default()
}

/// Periods that differ by less are the same: it is far below what any result resolves, and above
/// the rounding of times that are written with a few decimals.
const PERIOD_TOLERANCE: f64 = 1e-3;

fn load_one(path: &Path, options: &DatasetOptions) -> Result<Loaded, DatasetError> {
    let bytes = crate::data::input_file::read(path).map_err(|reason| TableError::Unreadable {
        path: path.to_owned(),
        reason,
    })?;
    let named = options.input.is_some() || options.output.is_some();
    let is_recording = recording::is_recording(&bytes);
    if is_recording && !named {
        return from_recordings::from_recording(&Recording::parse(&bytes, path)?, path, options);
    }
    if let Some(error) = refused_json(&bytes, path) {
        return Err(error);
    }
    let remark = is_recording.then(|| from_recordings::remark_on_named(&bytes, path));
    let mut loaded = match from_tables::from_table(&Table::parse(path, bytes)?, options) {
        Err(DatasetError::Table(TableError::NoColumn {
            path,
            column,
            present,
        })) if is_recording => {
            return Err(DatasetError::OtherColumns {
                path,
                column,
                present,
            });
        }
        loaded => loaded?,
    };
    loaded.about.remarks.extend(remark);
    Ok(loaded)
}

/// Why a file in JSON is no recording; `None` for what is no JSON.
fn refused_json(bytes: &[u8], path: &Path) -> Option<DatasetError> {
    let path = path.to_owned();
    if !bytes.trim_ascii_start().starts_with(b"{") {
        return None;
    }
    let value: serde_json::Value = serde_json::from_slice(bytes).ok()?;
    Some(match value.get("theta") {
        Some(_) => DatasetError::Model { path },
        None => DatasetError::Json { path },
    })
}

fn run(
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

#[cfg(test)]
mod tests;
