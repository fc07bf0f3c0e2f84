//! Why files did not become a record.

use crate::data::model_metadata::UnitsDiffer;
use crate::data::recording::ReadError;
use crate::data::table::TableError;
use crate::data::timeline::TimeFault;
use servoid_identification::Error as DataError;
use std::path::PathBuf;

/// Why files did not become a record. The text names the remedy.
#[derive(Debug, thiserror::Error)]
pub enum DatasetError {
    /// A recording.
    #[error(transparent)]
    Recording(#[from] ReadError),
    /// A table.
    #[error(transparent)]
    Table(#[from] TableError),
    /// The numbers themselves.
    #[error("{files}: {error}")]
    Data {
        /// Which files.
        files: String,
        /// What is wrong with them.
        error: DataError,
    },
    /// A file that is named twice.
    #[error("{path:?} is named twice: a run that counts twice makes bounds narrower than they are")]
    Twice {
        /// Which file.
        path: PathBuf,
    },
    /// A recording without a sample of the reference.
    #[error(
        "{path:?} has nothing to identify: it is {end}, and its {rows} rows end before the reference begins (sample {begins})"
    )]
    NoReference {
        /// Which file.
        path: PathBuf,
        /// Complete, or partial and why.
        end: String,
        /// Rows in it.
        rows: usize,
        /// The first sample of the reference.
        begins: u64,
    },
    /// Files in different units.
    #[error(transparent)]
    MixedUnits(#[from] UnitsDiffer),
    /// One column for both.
    #[error(
        "{path:?}: column {column:?} cannot be both the input and the output: name two columns"
    )]
    OneColumn {
        /// Which file.
        path: PathBuf,
        /// The column.
        column: String,
    },
    /// Columns of another file were named.
    #[error(
        "{path:?} is a recording of servoid and has no column {column:?} (its columns are {present}): leave the names of columns out, and it is read as what it is"
    )]
    OtherColumns {
        /// Which file.
        path: PathBuf,
        /// The column that it has not.
        column: String,
        /// What there is.
        present: String,
    },
    /// Columns are not named.
    #[error(
        "{path:?} is no recording of servoid, so say which of its columns is what; {columns}, so perhaps add: {options}"
    )]
    Unnamed {
        /// Which file.
        path: PathBuf,
        /// What there is, as a clause.
        columns: String,
        /// What to add to the command, as far as the names of the columns tell.
        options: String,
    },
    /// The sampling period is not known.
    #[error(
        "{path:?} has no column that is called like one of time ('t', 'time_ms', 'Zeit [s]', say): name it with --time COLUMN, or say how far apart the rows are with --period SECONDS"
    )]
    NoPeriod {
        /// Which file.
        path: PathBuf,
    },
    /// A column of time without numbers.
    #[error(
        "{path:?}: column {column:?} has times that are no numbers: say how far apart the rows are with --period SECONDS"
    )]
    TimeNotNumbers {
        /// Which file.
        path: PathBuf,
        /// The column of time.
        column: String,
    },
    /// A column of time that says no period.
    #[error(
        "{path:?}: column {column:?} has {reason}; say how far apart the rows are meant to be with --period SECONDS"
    )]
    UnevenTime {
        /// Which file.
        path: PathBuf,
        /// The column of time.
        column: String,
        /// What its steps are like.
        reason: TimeFault,
    },
    /// A column of time whose unit is not certain.
    #[error(
        "{path:?}: column {column:?} does not say its unit, and its steps of {step} are long for seconds: say --time-unit ms, --time-unit us or --time-unit s"
    )]
    NoTimeUnit {
        /// Which file.
        path: PathBuf,
        /// The column of time.
        column: String,
        /// Its usual step.
        step: f64,
    },
    /// No recording but a model.
    #[error(
        "{path:?} is a model as 'servoid identify -o' writes it, and recordings are needed here: name the CSV file that it comes from"
    )]
    Model {
        /// Which file.
        path: PathBuf,
    },
    /// No recording but other JSON.
    #[error("{path:?} is JSON, and recordings are CSV files: name one")]
    Json {
        /// Which file.
        path: PathBuf,
    },
    /// Files that do not go together.
    #[error(
        "{path:?} was sampled every {found} s and the file before it every {expected} s: identify them apart"
    )]
    MixedPeriods {
        /// Which file.
        path: PathBuf,
        /// Its period (s).
        found: f64,
        /// The other's period (s).
        expected: f64,
    },
    /// Files that do not go together.
    #[error(
        "{path:?} was sampled {found} s after the edges of its reference and the file before it {expected} s: identify them apart"
    )]
    MixedPhases {
        /// Which file.
        path: PathBuf,
        /// Its phase (s).
        found: f64,
        /// The other's phase (s).
        expected: f64,
    },
}
