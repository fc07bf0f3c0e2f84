//! Any CSV file with a header row, as columns of numbers.

// What files and lines bring meets no panic here.
#![cfg_attr(
    not(test),
    deny(
        clippy::expect_used,
        clippy::indexing_slicing,
        clippy::panic,
        clippy::unreachable,
        clippy::unwrap_used
    )
)]

use std::path::{Path, PathBuf};

/// Why a table could not be read. The text says what to do.
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

/// A CSV file in memory, its header row read. Lines that begin with `#` are passed over.
#[derive(Debug)]
pub struct Table {
    path: PathBuf,
    bytes: Vec<u8>,
    columns: Vec<String>,
}

impl Table {
    /// Reads a file.
    ///
    /// # Errors
    /// [`TableError::Unreadable`], [`TableError::Empty`] or [`TableError::NotCsv`].
    pub fn read(path: &Path) -> Result<Self, TableError> {
        let bytes = std::fs::read(path).map_err(|reason| TableError::Unreadable {
            path: path.to_owned(),
            reason,
        })?;
        Self::parse(path, bytes)
    }

    /// Takes over a file that is in memory already; `path` is what error texts call it.
    ///
    /// # Errors
    /// [`TableError::Empty`] or [`TableError::NotCsv`].
    pub fn parse(path: &Path, bytes: Vec<u8>) -> Result<Self, TableError> {
        let path = path.to_owned();
        let mut reader = csv_reader(&bytes);
        let columns: Vec<String> = match reader.headers() {
            Ok(headers) => headers.iter().map(str::to_owned).collect(),
            Err(error) => {
                return Err(TableError::NotCsv {
                    path,
                    reason: in_words(&error),
                });
            }
        };
        if columns.iter().all(String::is_empty) {
            return Err(TableError::Empty { path });
        }
        Ok(Self {
            path,
            bytes,
            columns,
        })
    }

    /// Where it comes from.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The column names, in order.
    #[must_use]
    pub fn columns(&self) -> &[String] {
        &self.columns
    }

    /// The column names as a list for error texts.
    #[must_use]
    pub fn columns_listed(&self) -> String {
        self.columns.join(", ")
    }

    /// The named columns, all of one length; NaN where a cell is empty. One pass over the file
    /// serves all of them.
    ///
    /// # Errors
    /// [`TableError::NoColumn`], [`TableError::NotANumber`] or [`TableError::NotCsv`].
    pub fn numbers(&self, names: &[&str]) -> Result<Vec<Vec<f64>>, TableError> {
        let mut columns = Vec::with_capacity(names.len());
        for name in names {
            columns.push((self.place_of(name)?, Vec::new()));
        }
        let mut reader = csv_reader(&self.bytes);
        let mut record = csv::ByteRecord::new();
        loop {
            match reader.read_byte_record(&mut record) {
                Ok(true) => {}
                Ok(false) => return Ok(columns.into_iter().map(|(_, numbers)| numbers).collect()),
                Err(error) => {
                    let path = self.path.clone();
                    return Err(TableError::NotCsv {
                        path,
                        reason: in_words(&error),
                    });
                }
            }
            for ((place, numbers), name) in columns.iter_mut().zip(names) {
                let cell = record.get(*place).unwrap_or_default().trim_ascii();
                let number = number(cell).ok_or_else(|| TableError::NotANumber {
                    path: self.path.clone(),
                    column: (*name).to_owned(),
                    line: record.position().map_or(0, csv::Position::line),
                    text: String::from_utf8_lossy(cell).chars().take(40).collect(),
                })?;
                numbers.push(number);
            }
        }
    }

    fn place_of(&self, name: &str) -> Result<usize, TableError> {
        self.columns
            .iter()
            .position(|column| column == name)
            .ok_or_else(|| TableError::NoColumn {
                path: self.path.clone(),
                column: name.to_owned(),
                present: self.columns_listed(),
            })
    }
}

fn csv_reader(bytes: &[u8]) -> csv::Reader<&[u8]> {
    csv::ReaderBuilder::new()
        .comment(Some(b'#'))
        // Cells are trimmed where they are read: trimming whole rows would copy each of them.
        .trim(csv::Trim::Headers)
        .from_reader(bytes)
}

/// What is wrong with a CSV file, in words of a user.
fn in_words(error: &csv::Error) -> String {
    match error.kind() {
        csv::ErrorKind::UnequalLengths {
            pos,
            expected_len,
            len,
        } => format!(
            "line {} has {len} cells where the header row has {expected_len}; it may be cut off there",
            pos.as_ref().map_or(0, csv::Position::line)
        ),
        csv::ErrorKind::Utf8 { .. } => "it is not text in UTF-8".to_owned(),
        _ => error.to_string(),
    }
}

/// A cell's number; NaN where it is empty, `None` where it is neither.
fn number(cell: &[u8]) -> Option<f64> {
    if cell.is_empty() {
        return Some(f64::NAN);
    }
    let number: f64 = std::str::from_utf8(cell).ok()?.parse().ok()?;
    number.is_finite().then_some(number)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(text: &str) -> Result<Table, TableError> {
        Table::parse(Path::new("x.csv"), text.as_bytes().to_vec())
    }

    #[test]
    fn columns_are_found_by_name_and_empty_cells_are_missing_samples() {
        let table = table("# remark\n t , u,y\n0,1,2\n# another\n1,,4e-1\n").unwrap();
        let columns = table.numbers(&["y", "u"]).unwrap();
        assert_eq!(columns[0], [2.0, 0.4]);
        assert!(columns[1][0] == 1.0 && columns[1][1].is_nan());
    }

    #[test]
    fn spaces_around_cells_and_line_ends_of_windows_do_not_matter() {
        let table = table("u, y\r\n 1 ,\t2\r\n  , 3 \r\n").unwrap();
        let columns = table.numbers(&["u", "y"]).unwrap();
        assert_eq!(columns[1], [2.0, 3.0]);
        assert!(columns[0][0] == 1.0 && columns[0][1].is_nan());
    }

    #[test]
    fn each_mistake_is_one_sentence_that_names_the_place() {
        let errors = [
            table("").unwrap_err(),
            table("u,y\n1,nan\n")
                .unwrap()
                .numbers(&["u", "y"])
                .unwrap_err(),
            table("u,y\n1,2\n1,inf\n")
                .unwrap()
                .numbers(&["y"])
                .unwrap_err(),
            table("u,y\n1,2\n").unwrap().numbers(&["z"]).unwrap_err(),
            table("u,y\n1,2\n1\n").unwrap().numbers(&["u"]).unwrap_err(),
        ];
        for (error, words) in errors.iter().zip([
            "empty",
            "line 2, column \"y\": \"nan\"",
            "line 3",
            "columns are u, y",
            "line 3 has 1 cells",
        ]) {
            let text = error.to_string();
            assert!(text.contains(words) && !text.contains('\n'), "{text}");
        }
    }
}
