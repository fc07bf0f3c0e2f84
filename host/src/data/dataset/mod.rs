//! From files to a record: recordings of this program, or any CSV file with its columns named.
//!
//! Of a recording of this program only the reference is identified, not the rest at neutral around it,
//! which shows the noise of a servo that does not move and no more: the strokes from and to neutral are half
//! as long as those of the reference, and a servo does not answer half a stroke with half the motion. On the
//! simulated bench servo the rest made the model's error 2.6 times larger (0.128 against 0.050 degrees rms).

mod about;
mod command_changes;
mod controllers;
mod error;
mod from_arrays;
mod from_recordings;
mod from_tables;
mod loaded;
mod moving_command;
mod named_columns;
mod options;
mod pulse_waits;
mod run_labels;
mod sensor_delay;
mod sentinel_values;
pub(crate) mod suggested_columns;
mod time_column;
mod wrapped_angle;

pub use about::About;
pub(crate) use command_changes::command_changes;
pub use error::{DatasetError, DatasetFault};
pub use from_arrays::{ArrayRun, Arrays};
pub use loaded::listed;
pub(crate) use moving_command::own_part_s;
pub use options::DatasetOptions;
pub(crate) use pulse_waits::FRAME_S;
pub(crate) use sensor_delay::in_ms;
pub use time_column::TimeUnit;

use crate::data::file_error::FileError;
use crate::data::recording::{self, Recording};
use crate::data::table::{Table, TableFault};
use crate::data::{fingerprint, input_file, rest_error, seams, unlike_runs};
pub use controllers::{Controllers, UnknownController};
use loaded::Loaded;
use servoid_identification::diagnostics::ServoStopped;
use servoid_identification::servo_model::RecordedMotion;
use servoid_identification::{Record, only_stroke};
use std::path::{Path, PathBuf};

/// A record, and where it comes from.
#[derive(Clone, Debug)]
pub struct Dataset<'a> {
    /// The runs.
    pub record: Record<'a>,
    /// What drove them.
    pub controllers: Controllers,
    /// Where they come from.
    pub about: About,
}

/// Reads files, each one run or more, into one record.
pub fn load(paths: &[PathBuf], options: &DatasetOptions) -> Result<Dataset<'static>, DatasetError> {
    let mut all: Option<Loaded<'static>> = None;
    for (index, path) in paths.iter().enumerate() {
        // A run that counts twice would make bounds narrower than they are.
        let earlier = paths.get(..index).unwrap_or_default();
        let next = match earlier.iter().any(|other| is_same_file(other, path)) {
            true => Err(DatasetFault::Twice),
            false => load_one(path, options),
        };
        let next = next.map_err(FileError::at(path))?;
        match &mut all {
            Some(all) => all.append(next, earlier, path)?,
            None => all = Some(next),
        }
    }
    together(all.unwrap_or_default(), &listed(paths))
}

/// Whether both names are of one file: "a.csv" is "./a.csv".
fn is_same_file(a: &Path, b: &Path) -> bool {
    let resolved = |path: &Path| path.canonicalize().ok();
    a == b || resolved(a).is_some_and(|a| resolved(b) == Some(a))
}

/// [`load`] of the content of one file, which is called `path`.
pub fn of_bytes(
    bytes: Vec<u8>,
    path: &Path,
    options: &DatasetOptions,
) -> Result<Dataset<'static>, DatasetError> {
    let loaded = of_content(bytes, path, options).map_err(FileError::at(path))?;
    together(loaded, &path.display().to_string())
}

/// The data set of these arrays.
///
/// # Errors
/// Columns of unequal lengths, infinite values, a column that never changes, a period that is none.
pub fn of_arrays(arrays: Arrays<'_>) -> Result<Dataset<'_>, DatasetError> {
    let name = arrays.name.clone();
    together(arrays.loaded()?, &name)
}

/// The data set of all runs, which are called `names`.
fn together<'a>(all: Loaded<'a>, names: &str) -> Result<Dataset<'a>, DatasetError> {
    let Loaded {
        runs,
        controllers,
        rest,
        period_s,
        phase_s,
        mut about,
    } = all;
    let record =
        Record::new(period_s, runs).map_err(|error| DatasetError::Data(names.to_owned(), error))?;
    about.only_stroke = only_stroke(&record);
    about.recorded = RecordedMotion::of(&record);
    // The zero of a rig is a matter of its calibration.
    let uncalibrated = about.calibrations.is_empty();
    let findings = [
        unlike_runs::advice(&record, &about.provenance, about.input_unit.as_deref()),
        fingerprint::advice_on_repeats(&record),
        uncalibrated.then(|| seams::advice(&record)).flatten(),
        uncalibrated
            .then(|| rest_error::advice(&record, about.units()))
            .flatten(),
    ];
    // Identification has advice on it; validation and comparison only have this.
    let stopped = ServoStopped::of(&record);
    about.remarks.extend(stopped.map(|found| found.in_words()));
    for advice in findings.into_iter().flatten() {
        about.remarks.push(advice.finding.clone());
        about.advice.push(advice);
    }
    let units = [&about.input_unit, &about.output_unit];
    let units = units.map(|unit| unit.as_deref().unwrap_or_default());
    Ok(Dataset {
        record: (record.with_sample_phase(phase_s).with_rest(rest)).with_units(units),
        controllers: Controllers(controllers),
        about,
    })
}

/// What a model of polled commands makes of other files: nothing in these says how they were written.
const READ_AS_POLLED: &str = "the commands are taken as polled, half a row early, as those of the model were (--polled): in a file that has them in the rows in which they begin to act, the model \
    seems half a row later than it is; a copy of the model file with \"polled\": false reads them as written";

/// Reads files as the runs of a model were read (`like`), unless `options` say otherwise. Files that cannot be read so, such as
/// recordings of servoid, are read for themselves.
pub fn load_as(
    paths: &[PathBuf],
    options: &DatasetOptions,
    like: &DatasetOptions,
) -> Result<Dataset<'static>, DatasetError> {
    let joined = options.clone().or(like);
    if joined == *options {
        return load(paths, options);
    }
    let mut remarks = vec![
        "the files are read as those of the model were (columns, period, runs, rest); options override this".to_owned(),
    ];
    remarks.extend((joined.polled && !options.polled).then(|| READ_AS_POLLED.to_owned()));
    let mut found = load(paths, &joined);
    if let Some((without, remark)) = found
        .as_ref()
        .err()
        .and_then(|error| without_run(error, options, &joined))
    {
        remarks.push(remark);
        found = load(paths, &without).or(found);
    }
    let mut data = match found {
        Err(error) => return load(paths, options).map_err(|_| error),
        Ok(data) => data,
    };
    data.about.remarks.splice(0..0, remarks);
    Ok(data)
}

/// The options without a column of runs that only the files of the model had, where that is what is missing.
fn without_run(
    error: &DatasetError,
    options: &DatasetOptions,
    joined: &DatasetOptions,
) -> Option<(DatasetOptions, String)> {
    let run = joined.run.as_ref().filter(|_| options.run.is_none())?;
    let DatasetError::File(file) = error else {
        return None;
    };
    match &file.fault {
        DatasetFault::Table(TableFault::NoColumn { column, .. }) if column == run => Some((
            DatasetOptions {
                run: None,
                ..joined.clone()
            },
            format!(
                "there is no column {run:?} here, by which the files of the model were divided into runs: each file is one run"
            ),
        )),
        _ => None,
    }
}

/// Reads two sides that are to be compared. Where one side is recordings of servoid without
/// the columns that `options` name, and the other has them, `options` are how to read the other.
pub fn load_sides(
    sides: [&[PathBuf]; 2],
    options: [&DatasetOptions; 2],
) -> Result<[Dataset<'static>; 2], DatasetError> {
    let [options_a, options_b] = options;
    let as_recordings = |paths: &[PathBuf]| -> Result<Dataset<'static>, DatasetError> {
        let plain = DatasetOptions {
            with_rest: options_a.with_rest,
            ..DatasetOptions::default()
        };
        let mut side = load(paths, &plain)?;
        side.about.remarks.push(format!(
            "{} is read as the recording that it is; the columns were named for the other side",
            listed(paths)
        ));
        Ok(side)
    };
    match [load(sides[0], options_a), load(sides[1], options_b)] {
        [Err(a), Ok(b)] if has_other_columns(&a) => Ok([as_recordings(sides[0])?, b]),
        [Ok(a), Err(b)] if has_other_columns(&b) => Ok([a, as_recordings(sides[1])?]),
        // Columns were named for the other side, and that is where to look for the mistake.
        [Err(a), Err(error)] if has_other_columns(&a) => Err(error),
        [a, b] => Ok([a?, b?]),
    }
}

fn has_other_columns(error: &DatasetError) -> bool {
    matches!(error, DatasetError::File(file) if matches!(file.fault, DatasetFault::OtherColumns { .. }))
}

fn load_one(path: &Path, options: &DatasetOptions) -> Result<Loaded<'static>, DatasetFault> {
    let bytes = input_file::read(path).map_err(TableFault::Unreadable)?;
    of_content(bytes, path, options)
}

fn of_content(
    bytes: Vec<u8>,
    path: &Path,
    options: &DatasetOptions,
) -> Result<Loaded<'static>, DatasetFault> {
    let named = options.input.is_some() || options.output.is_some();
    let is_recording = recording::is_recording(&bytes);
    if is_recording && !named {
        return from_recordings::from_recording(&Recording::of(&bytes)?, path, options);
    }
    if let Some(fault) = refused_json(&bytes) {
        return Err(fault);
    }
    let header = is_recording
        .then(|| recording::header_as_it_reads(&bytes))
        .flatten();
    let state = is_recording.then(|| from_recordings::state(&bytes, path));
    let table = Table::parse(bytes)?;
    // A name without its unit, which another program's file may have in full, is not meant for a column of a recording.
    let mut wanted = [&options.input, &options.output].into_iter().flatten();
    if is_recording && let Some(column) = wanted.find(|name| !table.has_column_called(name)) {
        return Err(DatasetFault::OtherColumns {
            column: column.clone(),
            present: table.columns_listed(),
        });
    }
    let loaded = match from_tables::from_table(&table, path, options) {
        Err(DatasetFault::Table(TableFault::NoColumn { column, present })) if is_recording => {
            return Err(DatasetFault::OtherColumns { column, present });
        }
        loaded => loaded?,
    };
    let Some((header, state)) = header.zip(state) else {
        return Ok(loaded);
    };
    let mut loaded = named_columns::timed(loaded, &header, options)?;
    let file = path.display();
    loaded.about.remarks.push(format!(
        "{file} is a recording of servoid, but with its columns named its rows are not checked; what its header says of times is taken as it stands: {state}"
    ));
    Ok(loaded)
}

/// Why a file in JSON is no recording; `None` for what is no JSON.
fn refused_json(bytes: &[u8]) -> Option<DatasetFault> {
    if !bytes.trim_ascii_start().starts_with(b"{") {
        return None;
    }
    let value: serde_json::Value = serde_json::from_slice(bytes).ok()?;
    Some(match value.get("theta") {
        Some(_) => DatasetFault::Model,
        None => DatasetFault::Json,
    })
}

#[cfg(test)]
mod tests;
