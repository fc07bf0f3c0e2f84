//! The lines above the rows, and what a recording is known by.

use super::lines::{Line, Lines};
use super::{Damage, Newer, SAMPLE_PERIOD_S};
use crate::data::recording::header::{FIRST_LINE, HEADER_CRC};
use crate::data::recording::{COLUMNS, FORMAT, Header};
use crate::data::rig_file::is_usable_scale;
use crate::data::table::BYTE_ORDER_MARK;
use servoid_protocol::framing::CRC;
use toml::{Table, Value};

/// Lines among which the row of column names is, with room for keys that are not known yet.
const MOST_HEADER_LINES: usize = 100;

/// Whether `bytes` look like a recording of this program, sound or damaged or cut short, rather than
/// any other CSV file: by its first line, its columns, or the other keys of its header.
#[must_use]
pub fn is_recording(bytes: &[u8]) -> bool {
    let bytes = bytes.strip_prefix(BYTE_ORDER_MARK).unwrap_or(bytes);
    let begins = bytes.starts_with(FIRST_LINE.as_bytes())
        || FIRST_LINE.as_bytes().starts_with(bytes.trim_ascii_end());
    begins || column_row(bytes).is_some() || has_header_keys(bytes)
}

/// Number of the line, from 1, with the names of the columns.
pub(super) fn column_row(bytes: &[u8]) -> Option<usize> {
    let lines = bytes.split(|&b| b == b'\n').take(MOST_HEADER_LINES);
    lines
        .zip(1..)
        .find(|(line, _)| is_column_row(line))
        .map(|(_, number)| number)
}

/// Whether comments as the writer's are there; two, since one may be in anybody's file.
fn has_header_keys(bytes: &[u8]) -> bool {
    let keys = [
        "# servoid = ",
        "# started = ",
        "# condition = ",
        "# sample_period_s = ",
    ];
    let lines = bytes.split(|&b| b == b'\n').take(MOST_HEADER_LINES);
    let ours = |line: &&[u8]| keys.iter().any(|key| line.starts_with(key.as_bytes()));
    lines.filter(ours).take(2).count() == 2
}

fn is_column_row(line: &[u8]) -> bool {
    line.trim_ascii_end() == COLUMNS.join(",").as_bytes()
}

/// Times in rows are made of the period that every rig has: a header with another one would make
/// every time in the results wrong.
pub(super) fn hold_period_against_rows(header: &Header, damages: &mut Vec<Damage>) {
    let (said, written) = (header.sample_period_s, SAMPLE_PERIOD_S);
    // Far above the rounding of a number in text, far below what any clock is off by.
    let equal = (said - written).abs() <= 1e-9 * written;
    if !equal {
        damages.push(Damage {
            row: None,
            line: 1,
            reason: format!(
                "sample_period_s is {said}, and the rows are written {written} s apart"
            ),
        });
    }
}

/// A scale that no servo and no sensor has, such as 0, makes no number of any row: the usual one takes
/// its place, so that the rows can be kept.
pub(super) fn mend_scales(header: &mut Header, damages: &mut Vec<Damage>) {
    let usual = Header::default();
    let scales = [
        (
            "us_per_degree",
            &mut header.us_per_degree,
            usual.us_per_degree,
        ),
        (
            "degrees_per_count",
            &mut header.degrees_per_count,
            usual.degrees_per_count,
        ),
    ];
    for (key, scale, usual) in scales {
        if !is_usable_scale(*scale) {
            damages.push(Damage {
                row: None,
                line: 1,
                reason: format!("{key} is {scale}, which is no scale"),
            });
            *scale = usual;
        }
    }
}

/// Reads up to the row of column names, which is the line `columns` where there is one.
pub(super) fn read_header(
    lines: &mut Lines<'_>,
    columns: Option<usize>,
    damages: &mut Vec<Damage>,
) -> Result<Header, Newer> {
    let (mut table, mut digest, mut sealed) = (Table::new(), CRC.digest(), None);
    let mut damage = |line, reason: &str| {
        damages.push(Damage {
            row: None,
            line,
            reason: reason.to_owned(),
        });
    };
    let (mut last, mut rows_follow) = (0, false);
    for Line { number, bytes, .. } in lines {
        last = number;
        let text = bytes.trim_ascii_end();
        let Some(comment) = text.strip_prefix(b"#") else {
            if columns.is_some_and(|columns| number < columns) {
                damage(number, "it is not of the form '# key = value'");
                digest.update(bytes);
                continue;
            }
            if !is_column_row(text) {
                damage(number, "the column names are wrong");
            }
            rows_follow = true;
            break;
        };
        match comment_table(comment) {
            Ok(entry) => {
                if let Some(crc32) = entry.get(HEADER_CRC).and_then(Value::as_str) {
                    let found = format!("{:08x}", digest.clone().finalize());
                    sealed = Some(found == crc32);
                }
                table.extend(entry);
            }
            Err(reason) => damage(number, reason),
        }
        digest.update(bytes);
    }
    let format = table.get("format").and_then(Value::as_integer);
    let format = format.unwrap_or(FORMAT.into());
    if format > i64::from(FORMAT) {
        // A flipped digit is not a newer version: only a sound header says so.
        if sealed != Some(false) {
            return Err(Newer(u32::try_from(format).unwrap_or(u32::MAX)));
        }
    }
    if sealed == Some(false) || (sealed.is_none() && rows_follow && format > 1) {
        damage(last, "the lines above the rows do not match their CRC");
    }
    Ok(table.try_into().unwrap_or_else(|error: toml::de::Error| {
        damage(last, error.message());
        Header::default()
    }))
}

/// A comment is the inside of a TOML inline table: `key = value, key = value`.
pub(super) fn comment_table(comment: &[u8]) -> Result<Table, &'static str> {
    const FORM: &str = "it is not of the form '# key = value'";
    let text = std::str::from_utf8(comment).map_err(|_| "it is not UTF-8 text")?;
    let table: Result<Table, _> = toml::from_str(&format!("line = {{ {} }}", text.trim()));
    match table.map(|mut table| (table.remove("line"), table.is_empty())) {
        Ok((Some(Value::Table(inner)), true)) => Ok(inner),
        _ => Err(FORM),
    }
}
