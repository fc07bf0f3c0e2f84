//! The lines above the rows, and the marks by which a recording is recognised.

use super::comment::{NO_COMMENT, comment_table};
use super::damage::Damage;
use super::lines::{Line, Lines};
use crate::data::recording::header::{FIRST_LINE, FORMAT, HEADER_CRC, Header};
use crate::data::recording::row::{COLUMNS, COLUMNS_WITHOUT_PULSE, SAMPLE_PERIOD_S};
use crate::data::rig_file::is_usable_scale;
use crate::data::table::BYTE_ORDER_MARK;
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
        .find(|(line, _)| has_pulse(line).is_some())
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

/// Whether a row of column names has one for the pulse; `None` for any other line.
fn has_pulse(line: &[u8]) -> Option<bool> {
    let names = line.trim_ascii_end();
    let is = |columns: &str| names == columns.as_bytes();
    is(COLUMNS)
        .then_some(true)
        .or_else(|| is(COLUMNS_WITHOUT_PULSE).then_some(false))
}

/// A format that is higher than [`FORMAT`].
#[derive(Debug)]
pub(in crate::data::recording) struct Newer(pub(in crate::data::recording) u32);

/// The lines above the rows, read.
pub(super) struct Head {
    pub(super) header: Header,
    /// Whether they are as they were written, as far as that can be known.
    pub(super) is_sound: bool,
    /// Whether the rows have a column of the pulse.
    pub(super) has_pulse: bool,
    pub(super) damages: Vec<Damage>,
}

impl Head {
    /// Reads up to the row of column names, which is the line `columns` where there is one.
    pub(super) fn read(lines: &mut Lines<'_>, columns: Option<usize>) -> Result<Self, Newer> {
        let mut damages = Vec::new();
        let mut damage = |line, reason: &str| damages.push(Damage::above_rows(line, reason));
        let (mut table, mut digest, mut seal) = (Table::new(), crc32fast::Hasher::new(), None);
        let (mut last, mut names) = (0, None);
        for Line { number, bytes } in lines {
            last = number;
            let text = bytes.trim_ascii_end();
            let Some(comment) = text.strip_prefix(b"#") else {
                if columns.is_some_and(|columns| number < columns) {
                    damage(number, NO_COMMENT);
                    digest.update(bytes);
                    continue;
                }
                names = Some(has_pulse(text));
                break;
            };
            match comment_table(comment) {
                Ok(entry) => {
                    if let Some(crc32) = entry.get(HEADER_CRC).and_then(Value::as_str) {
                        seal = Some(format!("{:08x}", digest.clone().finalize()) == crc32);
                    }
                    table.extend(entry);
                }
                Err(reason) => damage(number, reason),
            }
            digest.update(bytes);
        }
        if names == Some(None) {
            damage(last, "the column names are wrong");
        }
        let format = table.get("format").and_then(Value::as_integer);
        let format = format.unwrap_or(FORMAT.into());
        // A flipped digit is not a newer version: only a sound header says so.
        if format > i64::from(FORMAT) && seal != Some(false) {
            return Err(Newer(u32::try_from(format).unwrap_or(u32::MAX)));
        }
        if seal == Some(false) || (seal.is_none() && names.is_some() && format > 1) {
            damage(last, "the lines above the rows do not match their CRC");
        }
        let header = table.try_into().unwrap_or_else(|error: toml::de::Error| {
            damage(last, error.message());
            Header::default()
        });
        let mut head = Self {
            header,
            is_sound: false,
            has_pulse: names.flatten().unwrap_or(format > 2),
            damages,
        };
        head.mend_scales();
        head.is_sound = head.damages.is_empty();
        head.check_period();
        Ok(head)
    }

    /// A scale that no servo and no sensor has, such as 0, makes no number of any row: the usual one takes
    /// its place, so that the rows can be kept.
    fn mend_scales(&mut self) {
        let usual = Header::default();
        let header = &mut self.header;
        for (key, scale, usual) in [
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
        ] {
            if !is_usable_scale(*scale) {
                let reason = format!("{key} is {scale}, which is no scale");
                self.damages.push(Damage::above_rows(1, reason));
                *scale = usual;
            }
        }
    }

    /// Times in rows are made of the period that every rig has: a header with another one would make
    /// every time in the results wrong.
    fn check_period(&mut self) {
        let (said, written) = (self.header.sample_period_s, SAMPLE_PERIOD_S);
        // Far above the rounding of a number in text, far below what any clock is off by.
        let equal = (said - written).abs() <= 1e-9 * written;
        if !equal {
            let reason =
                format!("sample_period_s is {said}, and the rows are written {written} s apart");
            self.damages.push(Damage::above_rows(1, reason));
        }
    }
}
