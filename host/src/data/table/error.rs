//! Why a table could not be read.

use std::path::PathBuf;

/// Why a table could not be read. The text names the remedy.
#[derive(Debug, thiserror::Error)]
pub enum TableError {
    /// The file cannot be read.
    #[error("{path:?} cannot be read: {reason}")]
    Unreadable {
        /// Which.
        path: PathBuf,
        /// What the system said.
        reason: std::io::Error,
    },
    /// No header row.
    #[error("{path:?} is empty: a header row with column names and at least two rows are needed")]
    Empty {
        /// Which.
        path: PathBuf,
    },
    /// It is no CSV file.
    #[error("{path:?} is not a CSV file with a header row and even rows: {reason}")]
    NotCsv {
        /// Which.
        path: PathBuf,
        /// What is wrong, and where.
        reason: String,
    },
    /// No such column.
    #[error("{path:?} has no column {column:?}: its columns are {present}")]
    NoColumn {
        /// Which file.
        path: PathBuf,
        /// Which column.
        column: String,
        /// What there is.
        present: String,
    },
    /// Several columns that could be meant.
    #[error(
        "{path:?} has several columns that {column:?} could mean ({present}): give the one that is meant its full name, or a name of its own in the file"
    )]
    SeveralColumns {
        /// Which file.
        path: PathBuf,
        /// Which column.
        column: String,
        /// What it could mean.
        present: String,
    },
    /// Numbers with points and numbers with commas in one table.
    #[error(
        "{path:?} has numbers with a decimal comma (line {comma}) and numbers with a decimal point (line {point}), so that neither is certain: write it with one of the two"
    )]
    MixedDecimals {
        /// Which file.
        path: PathBuf,
        /// A line with a comma.
        comma: u64,
        /// A line with a point.
        point: u64,
    },
    /// A cell is no number.
    #[error(
        "{path:?} line {line}, column {column:?}: {text:?} is no finite number (leave the cell empty where a sample is missing)"
    )]
    NotANumber {
        /// Which file.
        path: PathBuf,
        /// Which column.
        column: String,
        /// Line, from 1.
        line: u64,
        /// The cell's text.
        text: String,
    },
}
