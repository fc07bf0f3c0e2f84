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
        "line {line}, column {column:?}: {text:?} is no finite number ({})",
        remedy.in_words()
    )]
    NotANumber {
        /// The column.
        column: String,
        /// Line, from 1.
        line: u64,
        /// The cell's text.
        text: String,
        /// What to do about it.
        remedy: Remedy,
    },
}

/// What to do about a cell that is no number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Remedy {
    /// Nothing but that it is missing can be meant.
    LeaveEmpty,
    /// The row is the header row once more.
    LeaveHeaderOut,
    /// The number has a comma in it, among cells that are parted by commas.
    DecimalPoint,
    /// The number has its unit behind it.
    UnitInHeader,
}

impl Remedy {
    fn in_words(self) -> &'static str {
        match self {
            Self::LeaveEmpty => "leave the cell empty where a sample is missing",
            Self::LeaveHeaderOut => {
                "this is the header row once more: leave the line out, and where a new run begins there, number the runs in a column for --run"
            }
            Self::DecimalPoint => {
                "where that is a decimal comma, write points, or part the cells by semicolons or tabs; where it parts thousands, leave it out"
            }
            Self::UnitInHeader => {
                "write the unit in the header row, as in 'angle [deg]', and the number alone in the cell"
            }
        }
    }
}
