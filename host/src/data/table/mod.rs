//! Any CSV file, as columns of numbers.

mod error;
mod layout;
mod number;

pub use error::TableError;
pub(crate) use layout::is_unit;

use layout::{Layout, fits};
use number::Decimal;
use std::path::{Path, PathBuf};

/// A CSV file in memory, its header row read. Lines that begin with `#` are passed over; cells may be
/// parted by commas, semicolons or tabs, and numbers may have a decimal comma where cells have not.
#[derive(Debug)]
pub struct Table {
    path: PathBuf,
    bytes: Vec<u8>,
    layout: Layout,
    decimal: Decimal,
}

/// What opens files that are no text: a sentence for those that people give.
const NOT_TEXT: [(&[u8], &str); 5] = [
    (
        b"PK\x03\x04",
        "it is a workbook or an archive: save the sheet as CSV",
    ),
    (
        b"\xD0\xCF\x11\xE0",
        "it is an old workbook: save the sheet as CSV",
    ),
    (b"\xFF\xFE", "it is text in UTF-16: save it as UTF-8"),
    (b"\xFE\xFF", "it is text in UTF-16: save it as UTF-8"),
    (
        b"MATLAB 5.0 MAT-file",
        "it is a MAT-file of MATLAB: write the variables with writetable or writematrix",
    ),
];

/// Columns that an error text names.
const MOST_LISTED: usize = 30;

/// What some programs put before text in UTF-8.
pub(crate) const BYTE_ORDER_MARK: &[u8] = b"\xEF\xBB\xBF";

impl Table {
    /// Reads a file.
    ///
    /// # Errors
    /// [`TableError::Unreadable`], [`TableError::Empty`] or [`TableError::NotCsv`].
    pub fn read(path: &Path) -> Result<Self, TableError> {
        let bytes =
            crate::data::input_file::read(path).map_err(|reason| TableError::Unreadable {
                path: path.to_owned(),
                reason,
            })?;
        Self::parse(path, bytes)
    }

    /// Takes over a file that is in memory already; `path` is what error texts call it.
    ///
    /// # Errors
    /// [`TableError::Empty`] or [`TableError::NotCsv`].
    pub fn parse(path: &Path, mut bytes: Vec<u8>) -> Result<Self, TableError> {
        let path = path.to_owned();
        let refused = |path: PathBuf, reason: &str| TableError::NotCsv {
            path,
            reason: reason.to_owned(),
        };
        if let Some((_, reason)) = NOT_TEXT.iter().find(|(start, _)| bytes.starts_with(start)) {
            return Err(refused(path, reason));
        }
        if bytes.starts_with(BYTE_ORDER_MARK) {
            bytes.drain(..BYTE_ORDER_MARK.len());
        }
        let Some(layout) = Layout::of(&bytes) else {
            return Err(TableError::Empty { path });
        };
        if let [only] = &layout.columns[..]
            && only.split_whitespace().count() > 1
            && parted_by_spaces(bytes.get(layout.rows_at..).unwrap_or_default())
        {
            let reason = "its cells are parted by spaces: part them by commas, semicolons or tabs";
            return Err(refused(path, reason));
        }
        let rows = bytes.get(layout.rows_at..).unwrap_or_default();
        let decimal = match layout.separator {
            b',' => Decimal::Point,
            _ if memchr::memchr(b',', rows).is_some() => Decimal::Comma,
            _ => Decimal::Point,
        };
        Ok(Self {
            path,
            bytes,
            layout,
            decimal,
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
        &self.layout.columns
    }

    /// What a user should know of how the table was read.
    #[must_use]
    pub fn remarks(&self) -> &[String] {
        &self.layout.remarks
    }

    /// The whole name of the column that `name` means.
    ///
    /// # Errors
    /// [`TableError::NoColumn`] or [`TableError::SeveralColumns`].
    pub fn column(&self, name: &str) -> Result<&str, TableError> {
        let place = self.place_of(name)?;
        Ok(self.columns().get(place).map_or("", String::as_str))
    }

    /// The columns in a clause: "its columns are t, u, y".
    #[must_use]
    pub fn columns_said(&self) -> String {
        match self.layout.named {
            true => format!("its columns are {}", self.columns_listed()),
            false => format!(
                "it has no header row, so its columns are called 1 to {}",
                self.columns().len()
            ),
        }
    }

    /// The column names as a list for error texts, one with a comma or a control character in it in quotes,
    /// and of very many the first.
    #[must_use]
    pub fn columns_listed(&self) -> String {
        let said = |name: &String| match name.contains(|c: char| c == ',' || c.is_control()) {
            true => format!("{name:?}"),
            false => name.clone(),
        };
        let columns = self.columns();
        let mut names: Vec<String> = columns.iter().take(MOST_LISTED).map(said).collect();
        if columns.len() > MOST_LISTED {
            names.push(format!("and {} more", columns.len() - MOST_LISTED));
        }
        names.join(", ")
    }

    /// The named columns, all of one length; NaN where a cell is empty or says that it has no number.
    /// One pass over the file serves all of them. A column may be named without its unit ("angle" for
    /// "angle \[deg\]") and in letters of another size, where that leaves no doubt.
    ///
    /// # Errors
    /// [`TableError::NoColumn`], [`TableError::SeveralColumns`], [`TableError::NotANumber`],
    /// [`TableError::MixedDecimals`] or [`TableError::NotCsv`].
    pub fn numbers(&self, names: &[&str]) -> Result<Vec<Vec<f64>>, TableError> {
        Ok(self.numbers_beside(names, None)?.0)
    }

    /// The named columns, and in the same pass one that may hold something else than numbers: `None`
    /// then.
    ///
    /// # Errors
    /// As [`Table::numbers`], for the columns of `names`.
    #[allow(clippy::type_complexity, reason = "columns, and one more")]
    pub fn numbers_beside(
        &self,
        names: &[&str],
        beside: Option<&str>,
    ) -> Result<(Vec<Vec<f64>>, Option<Vec<f64>>), TableError> {
        let mut columns = Vec::with_capacity(names.len());
        for name in names {
            columns.push((self.place_of(name)?, Vec::new()));
        }
        let beside = beside.map(|name| self.place_of(name)).transpose()?;
        let mut other = beside.map(|_| Vec::new());
        let rows = self.bytes.get(self.layout.rows_at..).unwrap_or_default();
        let mut reader = reader(rows, self.layout.separator);
        let mut record = csv::ByteRecord::new();
        // First lines with a comma and with a point among the numbers read.
        let mut seen = [None; 2];
        loop {
            match reader.read_byte_record(&mut record) {
                Ok(true) => {}
                Ok(false) => {
                    let columns = columns.into_iter().map(|(_, numbers)| numbers);
                    return Ok((columns.collect(), other));
                }
                Err(error) => {
                    let path = self.path.clone();
                    return Err(TableError::NotCsv {
                        path,
                        reason: error.to_string(),
                    });
                }
            }
            if record.len() != self.columns().len() {
                self.check_width(&record)?;
            }
            for ((place, numbers), name) in columns.iter_mut().zip(names) {
                let cell = record.get(*place).unwrap_or_default().trim_ascii();
                let Some(number) = number::parse(cell, self.decimal) else {
                    return Err(TableError::NotANumber {
                        path: self.path.clone(),
                        column: (*name).to_owned(),
                        line: self.line_of(&record),
                        text: String::from_utf8_lossy(cell).chars().take(40).collect(),
                    });
                };
                if self.decimal == Decimal::Comma {
                    self.check_decimals(cell, &record, &mut seen)?;
                }
                numbers.push(number);
            }
            if let (Some(place), Some(numbers)) = (beside, &mut other) {
                let cell = record.get(place).unwrap_or_default().trim_ascii();
                match number::parse(cell, self.decimal) {
                    Some(number) => numbers.push(number),
                    None => other = None,
                }
            }
        }
    }

    /// Line of the file that a row is in, from 1.
    fn line_of(&self, record: &csv::ByteRecord) -> u64 {
        let above = self.bytes.get(..self.layout.rows_at).unwrap_or_default();
        let above = memchr::memchr_iter(b'\n', above).count() as u64;
        above + record.position().map_or(1, csv::Position::line)
    }

    fn check_width(&self, record: &csv::ByteRecord) -> Result<(), TableError> {
        let (width, found) = (self.columns().len(), record.len());
        let cells: Vec<&[u8]> = record.iter().collect();
        if fits(&cells, width) {
            return Ok(());
        }
        let hint = if found == 2 * width && self.layout.separator == b',' {
            "; where numbers have a decimal comma, part the cells by semicolons or tabs"
        } else {
            "; it may be cut off there"
        };
        Err(TableError::NotCsv {
            path: self.path.clone(),
            reason: format!(
                "line {} has {found} cells where the header row has {width}{hint}",
                self.line_of(record)
            ),
        })
    }

    /// "1.234" among numbers with a decimal comma may be a thousand or one.
    fn check_decimals(
        &self,
        cell: &[u8],
        record: &csv::ByteRecord,
        seen: &mut [Option<u64>; 2],
    ) -> Result<(), TableError> {
        for (first, letter) in seen.iter_mut().zip([b',', b'.']) {
            if first.is_none() && memchr::memchr(letter, cell).is_some() {
                *first = Some(self.line_of(record));
            }
        }
        match *seen {
            [Some(comma), Some(point)] => Err(TableError::MixedDecimals {
                path: self.path.clone(),
                comma,
                point,
            }),
            _ => Ok(()),
        }
    }

    /// The column that is called so, or else the only one that is called so but for its unit and the
    /// size of its letters.
    fn place_of(&self, name: &str) -> Result<usize, TableError> {
        let alike = |same: &dyn Fn(&str) -> bool| -> Vec<usize> {
            let columns = self.columns().iter().enumerate();
            columns
                .filter(|(_, column)| same(column))
                .map(|(place, _)| place)
                .collect()
        };
        let wanted = name.trim().to_lowercase();
        let exact = alike(&|column| column == name);
        let found = match exact[..] {
            [] => alike(&|column| {
                let column = column.to_lowercase();
                column == wanted || without_unit(&column) == wanted
            }),
            _ => exact,
        };
        match found[..] {
            [place] => Ok(place),
            [] => Err(TableError::NoColumn {
                path: self.path.clone(),
                column: name.to_owned(),
                present: self.columns_listed(),
            }),
            _ => {
                let names = found.iter().filter_map(|&place| self.columns().get(place));
                Err(TableError::SeveralColumns {
                    path: self.path.clone(),
                    column: name.to_owned(),
                    present: names.cloned().collect::<Vec<_>>().join(", "),
                })
            }
        }
    }
}

/// "deg" of "angle \[deg\]", "angle (deg)" or "angle_deg"; `None` where a name says none.
///
/// ```
/// use servoid::data::table::unit_of;
/// assert_eq!(unit_of("Winkel [°]"), Some("°"));
/// assert_eq!(unit_of("pos_counts"), Some("counts"));
/// assert_eq!(unit_of("position"), None);
/// ```
#[must_use]
pub fn unit_of(column: &str) -> Option<&str> {
    let bracketed = column
        .trim_end()
        .strip_suffix([']', ')'])
        .and_then(|rest| rest.rsplit_once(['[', '(']))
        .map(|(_, unit)| unit.trim());
    let last = || {
        column
            .rsplit_once(['_', ' '])
            .map(|(_, word)| word)
            .filter(|word| is_unit(word) && word.chars().count() > 1)
    };
    bracketed.or_else(last).filter(|unit| !unit.is_empty())
}

/// "angle" for "angle [deg]" or "angle (deg)".
pub(crate) fn without_unit(column: &str) -> &str {
    column
        .split_once(['[', '('])
        .map_or(column, |(name, _)| name)
        .trim()
}

/// Whether the first row is several numbers with nothing but spaces between them.
fn parted_by_spaces(rows: &[u8]) -> bool {
    let line = rows.split(|byte| *byte == b'\n').next().unwrap_or_default();
    let words: Vec<&[u8]> = line
        .split(u8::is_ascii_whitespace)
        .filter(|word| !word.is_empty())
        .collect();
    let number = |word: &&[u8]| number::parse(word, Decimal::Point).is_some();
    words.len() > 1 && words.iter().all(number)
}

/// Reads rows of any length; cells are trimmed where they are used, as trimming whole rows would copy
/// each of them.
fn reader(rows: &[u8], separator: u8) -> csv::Reader<&[u8]> {
    csv::ReaderBuilder::new()
        .comment(Some(b'#'))
        .delimiter(separator)
        .has_headers(false)
        .flexible(true)
        .from_reader(rows)
}

#[cfg(test)]
mod tests;
