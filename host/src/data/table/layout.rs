//! The layout of a table: the place of its header row, and the separator of its cells.
//!
//! Programs write tables with commas, semicolons, tabs or vertical bars, with lines of text above the header row, with a
//! row of units below it, or without any header row. What is found is what the rows themselves confirm:
//! cells of numbers, as many as the header row has.

use super::number::{self, Decimal};
use super::rows::reader;

/// What may part cells, the most usual first.
const SEPARATORS: [u8; 4] = [b',', b';', b'\t', b'|'];

/// Lines looked at to find the layout: text above a table is shorter.
const LOOKED_AT: usize = 200;

/// Rows below a header row that have to confirm it, where there are so many.
const CONFIRMING: usize = 2;

/// How a table is laid out.
#[derive(Debug, PartialEq)]
pub(super) struct Layout {
    pub(super) separator: u8,
    /// Names of the columns, with the units of a row of units.
    pub(super) columns: Vec<String>,
    /// Whether the names are those of a header row, rather than numbers.
    pub(super) named: bool,
    /// Where the first row of numbers begins \[bytes\].
    pub(super) rows_at: usize,
    /// What a user should know of how it was found.
    pub(super) remarks: Vec<String>,
}

impl Layout {
    /// `None` where there is no line with anything in it.
    pub(super) fn of(bytes: &[u8]) -> Option<Self> {
        let layouts = SEPARATORS
            .iter()
            .filter_map(|&separator| Self::with(bytes, separator));
        // The first of equals.
        let best = layouts.rev().max_by_key(|(speaks, _)| *speaks);
        best.map(|(_, layout)| layout)
    }

    /// The layout with this separator, and what speaks for it: rows of numbers, cells of numbers, and where there are none, rows that have as many
    /// cells as the header row.
    fn with(bytes: &[u8], separator: u8) -> Option<((usize, usize, usize), Self)> {
        let (starts, cells): (Vec<usize>, Vec<Vec<String>>) =
            lines(bytes, separator).take(LOOKED_AT).unzip();
        let (header, rows) = headed(&cells, separator)
            .or_else(|| headless(&cells, separator))
            .unwrap_or((Some(0), 1));
        let first = header.unwrap_or(rows);
        let mut columns = match header {
            Some(header) => cells.get(header)?.clone(),
            None => (1..=cells.get(rows)?.len())
                .map(|k| k.to_string())
                .collect(),
        };
        // A row between header row and numbers is one of units.
        let units = header
            .filter(|header| header + 2 == rows)
            .and_then(|header| cells.get(header + 1));
        for (column, unit) in columns.iter_mut().zip(units.into_iter().flatten()) {
            add_unit(column, unit);
        }
        let mut remarks = Vec::new();
        if first > 0 {
            remarks.push(match first {
                1 => "one line above its header row is passed over".to_owned(),
                _ => format!("{first} lines above its header row are passed over"),
            });
        }
        if header.is_none() {
            remarks.push(format!(
                "it has no header row; its columns are called 1 to {} here",
                columns.len()
            ));
        }
        let kinds = cells.iter().skip(rows);
        let matching = kinds.filter(|cells| fits(cells.iter(), columns.len()));
        let numbers = matching.map(|cells| numbers_in(cells, separator));
        let (count, total, even) = numbers.fold((0, 0, 0), |(rows, all, even), n| {
            (rows + usize::from(n > 0), all + n, even + 1)
        });
        // More columns are no better by themselves, rows of numbers are.
        let speaks = if columns.len() > 1 {
            (count, total, even)
        } else {
            (0, total, 0)
        };
        let rows_at = starts.get(rows).copied().unwrap_or(bytes.len());
        Some((
            speaks,
            Self {
                separator,
                columns,
                named: header.is_some(),
                rows_at,
                remarks,
            },
        ))
    }
}

/// The header row and the first row of numbers: the header has no numbers, rows of as many cells with
/// numbers follow, perhaps behind a row of units.
fn headed(lines: &[Vec<String>], separator: u8) -> Option<(Option<usize>, usize)> {
    let is_row = |at: usize, width: usize| {
        let line = lines.get(at);
        line.is_none_or(|cells| fits(cells.iter(), width) && numbers_in(cells, separator) > 0)
    };
    lines.iter().enumerate().find_map(|(header, cells)| {
        let width = cells.len();
        let named = cells.iter().any(|cell| !cell.is_empty());
        if !named || numbers_in(cells, separator) > 0 {
            return None;
        }
        let units = lines
            .get(header + 1)
            .is_some_and(|cells| are_units(cells, width));
        let rows = header + 1 + usize::from(units);
        let confirmed = rows < lines.len() && (rows..rows + CONFIRMING).all(|at| is_row(at, width));
        confirmed.then_some((Some(header), rows))
    })
}

/// No header row, and the first row: nothing but numbers in it and in the next.
fn headless(lines: &[Vec<String>], separator: u8) -> Option<(Option<usize>, usize)> {
    let all_numbers = |cells: &Vec<String>| {
        !cells.is_empty() && cells.iter().all(|cell| is_number(cell, separator))
    };
    let alike = |two: &[Vec<String>]| {
        two.iter().all(all_numbers)
            && two
                .iter()
                .all(|cells| Some(cells.len()) == two.first().map(Vec::len))
    };
    let first = lines.windows(2).position(alike)?;
    // Several cells above the numbers are names of columns, and do not fit for a reason.
    let above = first.checked_sub(1).and_then(|above| lines.get(above));
    if above.is_some_and(|cells| cells.len() > 1) {
        return None;
    }
    Some((None, first))
}

/// As many cells, or more that are empty: some programs end every row with a separator.
pub(super) fn fits<T: AsRef<[u8]>>(cells: impl ExactSizeIterator<Item = T>, width: usize) -> bool {
    cells.len() >= width
        && cells
            .skip(width)
            .all(|cell| cell.as_ref().trim_ascii().is_empty())
}

fn numbers_in(cells: &[String], separator: u8) -> usize {
    cells
        .iter()
        .filter(|cell| is_number(cell, separator))
        .count()
}

fn is_number(cell: &str, separator: u8) -> bool {
    let decimals: &[Decimal] = match separator {
        b',' => &[Decimal::Point],
        _ => &[Decimal::Point, Decimal::Comma],
    };
    let number = |decimal: &Decimal| number::parse(cell.as_bytes(), *decimal);
    decimals
        .iter()
        .filter_map(number)
        .any(|number| !number.is_nan())
}

/// Units that a row below the header row may have, in lower letters.
const UNITS: [&str; 46] = [
    "volt", "volts", "count", "ticks", "steps", "lsb", "adc", "percent", "grad", "°/s", "n", "rev",
    "bit", "s", "sec", "second", "seconds", "ms", "msec", "us", "µs", "μs", "usec", "ns", "min",
    "h", "hz", "deg", "degree", "degrees", "°", "rad", "deg/s", "rad/s", "m", "mm", "v", "mv", "a",
    "ma", "nm", "%", "counts", "rpm", "°c", "-",
];

/// Whether a word is a unit that is known.
pub(crate) fn is_unit(word: &str) -> bool {
    UNITS.contains(&word.to_lowercase().as_str())
}

/// Whether these cells are units of `width` columns: in brackets, or known ones.
fn are_units(cells: &[String], width: usize) -> bool {
    let unit = |cell: &String| {
        let bracketed = cell.starts_with(['[', '(']) && cell.ends_with([']', ')']);
        cell.is_empty() || bracketed || is_unit(cell)
    };
    fits(cells.iter(), width) && cells.iter().any(|cell| !cell.is_empty()) && cells.iter().all(unit)
}

/// "time" and "ms" or "[ms]" become "time [ms]".
fn add_unit(column: &mut String, unit: &str) {
    let unit = unit.trim_matches(['[', ']', '(', ')']);
    if !unit.is_empty() && unit != "-" {
        *column = format!("{column} [{unit}]");
    }
}

/// The text of a cell. Programs that do not write UTF-8 write Latin-1, whose letters have the numbers of
/// their characters: 0xB0 is the degree sign.
fn decoded(cell: &[u8]) -> String {
    match std::str::from_utf8(cell) {
        Ok(text) => text.to_owned(),
        Err(_) => cell.iter().map(|byte| char::from(*byte)).collect(),
    }
}

/// Where each line begins that has anything in it and is no remark, and its cells without spaces around them.
fn lines(bytes: &[u8], separator: u8) -> impl Iterator<Item = (usize, Vec<String>)> {
    let records = reader(bytes, separator).into_byte_records();
    // Every line is a record, and nothing else can go wrong in memory.
    records.map_while(Result::ok).filter_map(|record| {
        let start = record
            .position()
            .map_or(0, |position| position.byte() as usize);
        let cell = |cell| decoded(cell).trim().to_owned();
        let cells: Vec<String> = record.iter().map(cell).collect();
        (cells.len() > 1 || cells.iter().any(|cell| !cell.is_empty())).then_some((start, cells))
    })
}
