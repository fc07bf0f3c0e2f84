//! The lines above the rows, and the marks by which a recording is recognised.

use super::comment::{NO_COMMENT, comment_table};
use super::damage::Damage;
use crate::data::recording::header::{FIRST_LINE, FORMAT, HEADER_CRC, Header};
use crate::data::recording::read_error::ReadFault;
use crate::data::recording::row::Columns;
use crate::data::rig_file::is_usable_scale;
use crate::data::table::BYTE_ORDER_MARK;
use toml::{Table, Value};

/// Lines among which the row of column names is, with room for keys that are not known yet.
const MOST_HEADER_LINES: usize = 100;

/// Whether `bytes` look like a recording of this program, sound or damaged or cut short, rather than
/// any other CSV file: by its first line, its columns, or the other keys of its header.
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
        .find(|(line, _)| Columns::named(line).is_some())
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

/// The lines above the rows, read.
pub(super) struct Head {
    pub(super) header: Header,
    /// Whether they are as they were written, as far as that can be known.
    pub(super) is_sound: bool,
    /// The columns of the rows.
    pub(super) columns: Columns,
    /// Its own CRC as it is written, where it is sound.
    pub(super) crc: Option<String>,
    pub(super) damages: Vec<Damage>,
}

impl Head {
    /// Reads up to the row of column names, which is the line `columns` where there is one.
    pub(super) fn read<'a>(
        lines: &mut impl Iterator<Item = (usize, &'a [u8])>,
        columns: Option<usize>,
    ) -> Result<Self, ReadFault> {
        let mut damages = Vec::new();
        let mut damage = |line, reason: &str| {
            damages.push(Damage {
                row: None,
                line,
                reason: reason.to_owned(),
            });
        };
        let (mut table, mut digest, mut seal) = (Table::new(), crc32fast::Hasher::new(), None);
        let (mut last, mut names, mut stated) = (0, None, None);
        for (number, line) in lines {
            last = number;
            let text = line.trim_ascii_end();
            let comment = match text.strip_prefix(b"#") {
                Some(comment) => comment_table(comment),
                None if columns.is_some_and(|columns| number < columns) => Err(NO_COMMENT),
                None => {
                    names = Some(Columns::named(text));
                    break;
                }
            };
            match comment {
                Ok(entry) => {
                    if let Some(crc32) = entry.get(HEADER_CRC).and_then(Value::as_str) {
                        seal = Some(format!("{:08x}", digest.clone().finalize()) == crc32);
                        stated = Some(crc32.to_owned());
                    }
                    table.extend(entry);
                }
                Err(reason) => damage(number, reason),
            }
            digest.update(line);
        }
        // With such a line in two, the first of them has the names that early files had.
        let checked = table.get("row_checks").and_then(Value::as_bool) == Some(true);
        if checked && names == Some(Some(Columns::Unchecked)) {
            names = Some(None);
        }
        if names == Some(None) {
            damage(last, "the column names are wrong");
        }
        let format = table.get("format").and_then(Value::as_integer);
        let format = format.unwrap_or(FORMAT.into());
        // A flipped digit is not a newer version: only a sound header may state one.
        if format > i64::from(FORMAT) && seal != Some(false) {
            return Err(ReadFault::Newer(u32::try_from(format).unwrap_or(u32::MAX)));
        }
        if seal == Some(false) || (seal.is_none() && names.is_some() && format > 1) {
            damage(last, "the lines above the rows do not match their CRC");
        }
        let mut header = table.try_into().unwrap_or_else(|error: toml::de::Error| {
            damage(last, error.message());
            Header::default()
        });
        for reason in mend_scales(&mut header) {
            damage(1, &reason);
        }
        let is_sound = damages.is_empty();
        let crc = is_sound.then_some(stated).flatten();
        let unnamed = match format > 2 {
            true => Columns::Checked,
            false => Columns::WithoutPulse,
        };
        damages.extend(wrong_period(&header));
        Ok(Self {
            header,
            is_sound,
            columns: names.flatten().unwrap_or(unnamed),
            crc,
            damages,
        })
    }
}

/// Replaces a scale that no servo and no sensor has, such as 0, by the usual one, so that the rows can be kept;
/// returns the faults.
fn mend_scales(header: &mut Header) -> Vec<String> {
    let usual = Header::default();
    let Header {
        us_per_degree,
        degrees_per_count,
        ..
    } = header;
    let scales = [
        ("us_per_degree", us_per_degree, usual.us_per_degree),
        (
            "degrees_per_count",
            degrees_per_count,
            usual.degrees_per_count,
        ),
    ];
    let unusable = scales
        .into_iter()
        .filter(|(_, scale, _)| !is_usable_scale(**scale));
    unusable
        .map(|(key, scale, usual)| {
            let wrong = std::mem::replace(scale, usual);
            format!("{key} is {wrong}, which is no scale")
        })
        .collect()
}

/// Times in rows are made of the period of the train of pulses: a header with another one would make every time in the
/// results wrong.
fn wrong_period(header: &Header) -> Option<Damage> {
    let (stated, written) = (header.sample_period_s, header.train_of_rows().sample_s());
    // Far above the rounding of a number in text, far below what any clock is off by.
    let equal = (stated - written).abs() <= 1e-9 * written;
    (!equal).then(|| Damage {
        row: None,
        line: 1,
        reason: format!("sample_period_s is {stated}, and the rows are written {written} s apart"),
    })
}
