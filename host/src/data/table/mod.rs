//! Any CSV file, as columns of numbers.

mod clock_time;
mod column_unit;
mod cut_row;
mod error;
mod layout;
mod number;
mod rows;

pub use column_unit::unit_of;
pub(crate) use column_unit::without_unit;
pub use error::{Remedy, TableError, TableFault};
pub(crate) use layout::is_unit;

use crate::data::input_file;
use cut_row::cut_row;
use layout::{Layout, fits};
use number::Decimal;
use rows::reader;
use std::path::Path;

/// A CSV file in memory, its header row read. Lines that begin with `#` are passed over; cells may be
/// parted by commas, semicolons, tabs or vertical bars, and numbers may have a decimal comma where cells have not.
#[derive(Debug)]
pub struct Table {
    bytes: Vec<u8>,
    layout: Layout,
    decimal: Decimal,
    /// Whether a last row that was cut off is left out.
    is_cut: bool,
}

/// How files begin that are no text, and what to do about them.
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
    pub fn read(path: &Path) -> Result<Self, TableError> {
        let bytes = input_file::read(path).map_err(TableFault::Unreadable);
        bytes.and_then(Self::parse).map_err(TableError::at(path))
    }

    /// Reads a file that is in memory already.
    pub fn parse(mut bytes: Vec<u8>) -> Result<Self, TableFault> {
        let refused = |reason: &str| Err(TableFault::NotCsv(reason.to_owned()));
        if let Some((_, reason)) = NOT_TEXT.iter().find(|(start, _)| bytes.starts_with(start)) {
            return refused(reason);
        }
        if memchr::memchr(0, &bytes).is_some() {
            return refused("it has bytes of zero, as a file with a hole: it is no text");
        }
        if bytes.starts_with(BYTE_ORDER_MARK) {
            bytes.drain(..BYTE_ORDER_MARK.len());
        }
        let layout = Layout::of(&bytes).ok_or(TableFault::Empty)?;
        let rows = bytes.get(layout.rows_at..).unwrap_or_default();
        let cut = cut_row(rows, layout.separator);
        if let Some(begins) = cut {
            bytes.truncate(layout.rows_at + begins);
        }
        let rows = bytes.get(layout.rows_at..).unwrap_or_default();
        if let [only] = &layout.columns[..]
            && only.split_whitespace().count() > 1
            && parted_by_spaces(rows)
        {
            return refused(
                "its cells are parted by spaces: part them by commas, semicolons, tabs or vertical bars",
            );
        }
        let decimal = match layout.separator {
            b',' => Decimal::Point,
            _ if rows.contains(&b',') => Decimal::Comma,
            _ => Decimal::Point,
        };
        Ok(Self {
            bytes,
            layout,
            decimal,
            is_cut: cut.is_some(),
        })
    }

    /// The column names, in order.
    pub fn columns(&self) -> &[String] {
        &self.layout.columns
    }

    /// That the last row is left out, where it is taken for cut off.
    pub(crate) fn cut_row(&self) -> Option<String> {
        let remark = "its last row has no end of line, and fewer decimals than those before it: it is taken for cut off, and left out";
        self.is_cut.then(|| remark.to_owned())
    }

    /// What a user should know of how the table was read.
    pub fn remarks(&self) -> &[String] {
        &self.layout.remarks
    }

    /// The whole name of the column that `name` means.
    pub fn column(&self, name: &str) -> Result<&str, TableFault> {
        let place = self.place_of(name)?;
        Ok(self.columns().get(place).map_or("", String::as_str))
    }

    /// Whether a column has this name in full, in letters of any size.
    pub(crate) fn has_column_called(&self, name: &str) -> bool {
        let wanted = name.trim().to_lowercase();
        self.columns()
            .iter()
            .any(|column| column.to_lowercase() == wanted)
    }

    /// The columns in a clause: "its columns are t, u, y".
    pub(crate) fn columns_clause(&self) -> String {
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
    pub(crate) fn columns_listed(&self) -> String {
        let shown = |name: &String| match name.contains(|c: char| c == ',' || c.is_control()) {
            true => format!("{name:?}"),
            false => name.clone(),
        };
        let columns = self.columns();
        let mut names: Vec<String> = columns.iter().take(MOST_LISTED).map(shown).collect();
        if columns.len() > MOST_LISTED {
            names.push(format!("and {} more", columns.len() - MOST_LISTED));
        }
        names.join(", ")
    }

    /// The named columns, all of one length; NaN where a cell is empty or marked as missing. A column may be
    /// named without its unit ("angle" for "angle \[deg\]" or "angle_deg") and in letters of another size, where that leaves
    /// no doubt.
    pub fn numbers(&self, names: &[&str]) -> Result<Vec<Vec<f64>>, TableFault> {
        Ok(self.numbers_beside(names, None)?.0)
    }

    /// The named columns, and in the same pass one of times, which may be those of a clock or no numbers at all: `None`
    /// then.
    pub(crate) fn numbers_beside(
        &self,
        names: &[&str],
        beside: Option<&str>,
    ) -> Result<(Vec<Vec<f64>>, Option<Times>), TableFault> {
        let places: Vec<usize> = names
            .iter()
            .map(|name| self.place_of(name))
            .collect::<Result<_, _>>()?;
        let beside = beside.map(|name| self.place_of(name)).transpose()?;
        let mut columns = vec![Vec::new(); names.len()];
        let mut times = beside.map(|_| Times::default());
        let rows = self.bytes.get(self.layout.rows_at..).unwrap_or_default();
        let mut reader = reader(rows, self.layout.separator);
        let mut record = csv::ByteRecord::new();
        // First lines with a comma and with a point among the numbers read.
        let mut seen = [None; 2];
        while reader
            .read_byte_record(&mut record)
            .map_err(|error| TableFault::NotCsv(error.to_string()))?
        {
            self.check_width(&record)?;
            let cell = |place: usize| record.get(place).unwrap_or_default().trim_ascii();
            for ((&place, numbers), name) in places.iter().zip(&mut columns).zip(names) {
                let cell = cell(place);
                let number =
                    number::parse(cell, self.decimal).ok_or_else(|| TableFault::NotANumber {
                        column: (*name).to_owned(),
                        line: self.line_of(&record),
                        text: String::from_utf8_lossy(cell).chars().take(40).collect(),
                        remedy: self.remedy(&record, cell),
                    })?;
                if self.decimal == Decimal::Comma {
                    self.check_decimals(cell, &record, &mut seen)?;
                }
                numbers.push(number);
            }
            if let (Some(place), Some(found)) = (beside, &mut times)
                && !found.push(cell(place), self.decimal)
            {
                times = None;
            }
        }
        Ok((columns, times.map(Times::counted)))
    }

    /// The texts of a column, without spaces around them.
    pub(crate) fn texts(&self, name: &str) -> Result<Vec<String>, TableFault> {
        let place = self.place_of(name)?;
        let rows = self.bytes.get(self.layout.rows_at..).unwrap_or_default();
        let mut texts = Vec::new();
        for record in reader(rows, self.layout.separator).into_byte_records() {
            let record = record.map_err(|error| TableFault::NotCsv(error.to_string()))?;
            self.check_width(&record)?;
            let cell = record.get(place).unwrap_or_default().trim_ascii();
            texts.push(String::from_utf8_lossy(cell).into_owned());
        }
        Ok(texts)
    }

    /// What to do about this cell, which is no number.
    fn remedy(&self, record: &csv::ByteRecord, cell: &[u8]) -> Remedy {
        let text = String::from_utf8_lossy(cell);
        let head = text.trim_end_matches(|letter: char| !letter.is_ascii_digit());
        let is_number = |text: &str| {
            let parsed = |decimal| number::parse(text.as_bytes(), decimal);
            !text.is_empty() && (parsed(Decimal::Point).or(parsed(Decimal::Comma))).is_some()
        };
        let is_header = || {
            let mut both = record.iter().zip(self.columns());
            both.all(|(cell, name)| name.as_bytes().starts_with(cell.trim_ascii()))
        };
        if self.layout.named && is_header() {
            return Remedy::LeaveHeaderOut;
        }
        match (is_number(&text), is_number(head)) {
            (true, _) if text.contains(',') => Remedy::DecimalPoint,
            (false, true) => Remedy::UnitInHeader,
            _ => Remedy::LeaveEmpty,
        }
    }

    /// Whether a first column without a name goes up evenly, as times do.
    pub(crate) fn begins_with_times(&self) -> bool {
        let first = match self.columns() {
            [first, _, ..] if !self.layout.named => first,
            _ => return false,
        };
        let numbers = self.numbers(&[first.as_str()]);
        let numbers = numbers.ok().and_then(|mut columns| columns.pop());
        let [a, b, ..] = numbers.as_deref().unwrap_or_default() else {
            return false;
        };
        let (step, rows) = (b - a, numbers.iter().flatten());
        // Half a step for times that are rounded.
        let even = |(at, next): (&f64, &f64)| (next - at - step).abs() <= 0.5 * step;
        step > 0.0 && rows.clone().zip(rows.skip(1)).all(even)
    }

    /// Line of the file that a row is in, from 1.
    fn line_of(&self, record: &csv::ByteRecord) -> u64 {
        let above = self.bytes.get(..self.layout.rows_at).unwrap_or_default();
        let above = memchr::memchr_iter(b'\n', above).count() as u64;
        above + record.position().map_or(1, csv::Position::line)
    }

    fn check_width(&self, record: &csv::ByteRecord) -> Result<(), TableFault> {
        let (width, found) = (self.columns().len(), record.len());
        if found == width || fits(record.iter(), width) {
            return Ok(());
        }
        let hint = if found == 2 * width && self.layout.separator == b',' {
            "; where numbers have a decimal comma, part the cells by semicolons or tabs"
        } else {
            "; it may be cut off there"
        };
        Err(TableFault::NotCsv(format!(
            "line {} has {found} cells where the header row has {width}{hint}",
            self.line_of(record)
        )))
    }

    /// "1.234" among numbers with a decimal comma may be a thousand or one.
    fn check_decimals(
        &self,
        cell: &[u8],
        record: &csv::ByteRecord,
        seen: &mut [Option<u64>; 2],
    ) -> Result<(), TableFault> {
        for (first, letter) in seen.iter_mut().zip([b',', b'.']) {
            if first.is_none() && cell.contains(&letter) {
                *first = Some(self.line_of(record));
            }
        }
        match *seen {
            [Some(comma), Some(point)] => Err(TableFault::MixedDecimals { comma, point }),
            _ => Ok(()),
        }
    }

    /// The column that is called so, or else the only one that is called so but for its unit and the
    /// size of its letters.
    fn place_of(&self, name: &str) -> Result<usize, TableFault> {
        let columns = self.columns();
        let mut exact = (0..).zip(columns).filter(|(_, column)| *column == name);
        if let (Some((place, _)), None) = (exact.next(), exact.next()) {
            return Ok(place);
        }
        let wanted = name.trim().to_lowercase();
        let called = |means: fn(&str) -> &str| -> Vec<(usize, &String)> {
            let all = columns.iter().enumerate();
            all.filter(|(_, column)| means(&column.to_lowercase()) == wanted)
                .collect()
        };
        let mut found = called(|column| column);
        if found.is_empty() {
            found = called(without_unit);
        }
        let column = name.to_owned();
        match found[..] {
            [(place, _)] => Ok(place),
            [] => Err(TableFault::NoColumn {
                column,
                present: self.columns_listed() + &self.perhaps(&wanted),
            }),
            _ => Err(TableFault::SeveralColumns {
                column,
                present: found
                    .iter()
                    .map(|(_, name)| name.as_str())
                    .collect::<Vec<_>>()
                    .join(", "),
            }),
        }
    }
}

impl Table {
    /// The first column whose name has `wanted`, in small letters, in it, as a clause; empty where none has.
    fn perhaps(&self, wanted: &str) -> String {
        let has = |column: &&String| !wanted.is_empty() && column.to_lowercase().contains(wanted);
        let found = self.columns().iter().find(has);
        found.map_or(String::new(), |column| {
            format!("; perhaps {column:?} is meant")
        })
    }
}

/// A column of times.
#[derive(Debug, Default)]
pub(crate) struct Times {
    pub(crate) numbers: Vec<f64>,
    /// Whether they are those of a clock, in seconds from the first.
    pub(crate) of_clock: bool,
}

impl Times {
    /// Whether the cell is a time like those before it, or missing.
    fn push(&mut self, cell: &[u8], decimal: Decimal) -> bool {
        let number = number::parse(cell, decimal);
        let of_clock = match number {
            Some(_) => None,
            None => clock_time::seconds(cell),
        };
        let is_missing = number.is_some_and(f64::is_nan);
        let is_first = self.numbers.iter().all(|time| time.is_nan());
        if is_first && of_clock.is_some() {
            self.of_clock = true;
        }
        self.numbers.extend(number.or(of_clock));
        is_missing || self.of_clock && of_clock.is_some() || !self.of_clock && number.is_some()
    }

    fn counted(mut self) -> Self {
        if self.of_clock {
            clock_time::from_first(&mut self.numbers);
        }
        self
    }
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

#[cfg(test)]
mod tests;
