//! Why files did not become a record.

use crate::data::file_error::FileError;
use crate::data::model_metadata::UnitsDiffer;
use crate::data::recording::ReadFault;
use crate::data::table::TableFault;
use crate::data::timeline::TimeFault;
use servoid_identification::Error as DataError;

/// Why files did not become a record. The text names the remedy.
#[derive(Debug, thiserror::Error)]
pub enum DatasetError {
    /// One of them.
    #[error(transparent)]
    File(#[from] FileError<DatasetFault>),
    /// Files in different units.
    #[error(transparent)]
    MixedUnits(#[from] UnitsDiffer),
    /// The numbers themselves: which files, and what is wrong with them.
    #[error("{0}: {1}")]
    Data(String, DataError),
}

impl DatasetError {
    /// Whether a table has no column of a name that was given.
    pub(crate) fn is_of_a_missing_column(&self) -> bool {
        let Self::File(file) = self else { return false };
        matches!(file.fault, DatasetFault::Table(TableFault::NoColumn { .. }))
    }
}

/// A fault in a file.
#[derive(Debug, thiserror::Error)]
pub enum DatasetFault {
    /// A recording.
    #[error(transparent)]
    Recording(#[from] ReadFault),
    /// A table.
    #[error(transparent)]
    Table(#[from] TableFault),
    /// The numbers themselves.
    #[error("gives no run: {0}")]
    Run(#[from] DataError),
    /// A file that is named twice.
    #[error("is named twice: a run that counts twice makes bounds narrower than they are")]
    Twice,
    /// A recording without a sample of the reference.
    #[error(
        "has nothing to identify: it is {end}, and its {rows} rows end before the reference begins (sample {begins})"
    )]
    NoReference {
        /// Complete, or partial and why.
        end: String,
        /// Rows in it.
        rows: usize,
        /// The first sample of the reference.
        begins: u64,
    },
    /// One column for both.
    #[error(
        "has one column {0:?}, which cannot be both the input and the output: name two columns"
    )]
    OneColumn(String),
    /// Columns of another file were named.
    #[error(
        "is a recording of servoid and has no column {column:?} (its columns are {present}): leave the names of columns out, and it is read as what it is"
    )]
    OtherColumns {
        /// The column that it has not.
        column: String,
        /// Those that it has.
        present: String,
    },
    /// Columns are not named.
    #[error(
        "is no recording of servoid, so say which of its columns is what; {columns}, so perhaps add: {options}"
    )]
    Unnamed {
        /// Its columns, as a clause.
        columns: String,
        /// What to add to the command, as far as the names of the columns suggest it.
        options: String,
    },
    /// Rows of a single cell.
    #[error(
        "has one cell in each row ({0:?} in the header row), and a command and a position are needed: part cells by commas, semicolons, tabs or vertical bars"
    )]
    OneCell(String),
    /// The sampling period is not known.
    #[error(
        "has no column that is called like one of time ('t', 'time_ms', 'Zeit [s]', say): name it with --time COLUMN, or say how far apart the rows are with --period SECONDS"
    )]
    NoPeriod,
    /// A column of time without times.
    #[error(
        "has in column {0:?} times that are neither numbers nor those of a clock (14:00:01.230): write them as one of these, or say how far apart the rows are with --period SECONDS, which does not show rows that are missing"
    )]
    TimeNotNumbers(String),
    /// A column of time without a period, and what its steps are like.
    #[error(
        "has in column {0:?} {1}; where these times are right, interpolate the rows to even ones first; where the rows are even and the column is not, say how far apart they are with --period SECONDS"
    )]
    UnevenTime(String, TimeFault),
    /// A period that the column of time contradicts (s).
    #[error(
        "has rows {found} s apart by its column {column:?}, and --period {stated} says {stated} s: leave --period out to take the column; where it has another unit than its name says, state that one with --time-unit s, ms or us; where it is not the time, name another one with --time COLUMN"
    )]
    PeriodAgainstTime {
        /// As stated.
        stated: f64,
        /// The column of time.
        column: String,
        /// As the column has it.
        found: f64,
    },
    /// A column of time whose unit is not certain.
    #[error(
        "has a column {column:?} without a unit, and its steps of {step} are long for seconds: say --time-unit ms, --time-unit us or --time-unit s"
    )]
    NoTimeUnit {
        /// The column of time.
        column: String,
        /// Its usual step.
        step: f64,
    },
    /// No recording but a model.
    #[error(
        "is a model as 'servoid identify -o' writes it, and recordings are needed here: name the CSV file that it comes from"
    )]
    Model,
    /// No recording but other JSON.
    #[error("is JSON, and recordings are CSV files: name one")]
    Json,
    /// Files of different periods (s).
    #[error(
        "was sampled every {found} s and the file before it every {expected} s: record both at one rate, or identify them apart; where rows were meant to be equally far apart in both, state how far for all of them with --period"
    )]
    MixedPeriods {
        /// Its own.
        found: f64,
        /// The other's.
        expected: f64,
    },
    /// Files of different phases (s).
    #[error(
        "was sampled {found} s after the edges of its reference and the file before it {expected} s: identify them apart"
    )]
    MixedPhases {
        /// Its own.
        found: f64,
        /// The other's.
        expected: f64,
    },
}
