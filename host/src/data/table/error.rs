//! Why a table could not be read.

use crate::data::file_error::FileError;

/// Why a table could not be read.
pub type TableError = FileError<TableFault>;

/// A fault in a table.
#[derive(Debug, thiserror::Error)]
pub enum TableFault {
    /// The error of the system.
    #[error("cannot be read: {0}")]
    Unreadable(std::io::Error),
    /// No header row.
    #[error("is empty: a header row with column names and at least two rows are needed")]
    Empty,
    /// It is no CSV file, for this reason.
    #[error("is not a CSV file with a header row and even rows: {0}")]
    NotCsv(String),
    /// No such column.
    #[error("has no column {column:?}: its columns are {present}")]
    NoColumn {
        /// The column.
        column: String,
        /// Those of the table.
        present: String,
    },
    /// Several columns that could be meant.
    #[error(
        "has several columns that {column:?} could mean ({present}): give the one that is meant its full name, or a name of its own in the file"
    )]
    SeveralColumns {
        /// The column.
        column: String,
        /// Those that it could mean.
        present: String,
    },
    /// Numbers with points and numbers with commas in one table.
    #[error(
        "has numbers with a decimal comma (line {comma}) and numbers with a decimal point (line {point}), so that neither is certain: write it with one of the two"
    )]
    MixedDecimals {
        /// A line with a comma.
        comma: u64,
        /// A line with a point.
        point: u64,
    },
    /// A cell is no number.
    #[error(
        "line {line}, column {column:?}: {text:?} is no finite number (leave the cell empty where a sample is missing)"
    )]
    NotANumber {
        /// The column.
        column: String,
        /// Line, from 1.
        line: u64,
        /// The cell's text.
        text: String,
    },
}
