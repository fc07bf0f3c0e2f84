//! How a recording ends, and the line about it.

use super::header::on_one_line;
use serde::Deserialize;
use servoid_protocol::timing::SAMPLES_PER_FRAME;
use std::ops::Range;
use toml::{Table, Value};

/// What comes before the line's own CRC in it.
const END_CRC: &str = ", end_crc32 = ";

/// How a recording ends.
#[derive(Clone, Debug, PartialEq)]
pub enum Ending {
    /// Every sample of the run is in it, proved by the rig's own check.
    Complete,
    /// Ended on purpose before the reference was over: every sample until then is in it, proved by
    /// the rig's own check.
    Early {
        /// What had been reached, in plain words.
        reason: String,
    },
    /// Something is missing, or the run was cut short.
    Partial {
        /// Why, in plain words.
        reason: String,
        /// Frames of which nothing is there: those that were lost, and those that the run would
        /// still have had.
        lost_frames: Vec<Range<u32>>,
    },
}

impl Ending {
    /// The last line of a recording with `rows` rows of this CRC-32, sealed by a CRC-32 of its own.
    pub(super) fn last_line(&self, rows: u64, crc32: u32) -> String {
        let (end, reason, lost_frames) = match self {
            Self::Complete => ("complete", None, None),
            Self::Early { reason } => ("early", Some(reason), None),
            Self::Partial {
                reason,
                lost_frames,
            } => ("partial", Some(reason), Some(lost_frames)),
        };
        let mut line = format!("# end = \"{end}\", rows = {rows}, crc32 = \"{crc32:08x}\"");
        if let Some(reason) = reason {
            line += &format!(", reason = {}", on_one_line(&Value::from(reason.as_str())));
        }
        if let Some(lost) = lost_frames {
            let samples = |frame: u32| u64::from(frame) * SAMPLES_PER_FRAME as u64;
            let lost: Vec<_> = lost
                .iter()
                .filter(|f| !f.is_empty())
                .map(|f| format!("[{}, {}]", samples(f.start), samples(f.end) - 1))
                .collect();
            line += &format!(", lost_samples = [{}]", lost.join(", "));
        }
        let own_crc = crc32fast::hash(line.as_bytes());
        format!("{line}{END_CRC}\"{own_crc:08x}\"\n")
    }
}

/// A last line as it is read.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct LastLine {
    /// `complete`, `early` or `partial`.
    pub(super) end: String,
    /// Rows in the file.
    pub(super) rows: usize,
    /// CRC-32 over the rows.
    pub(super) crc32: String,
    pub(super) reason: Option<String>,
    /// The first and the last sample of each gap.
    #[serde(default)]
    pub(super) lost_samples: Vec<[u64; 2]>,
    end_crc32: Option<String>,
}

impl LastLine {
    /// Of `line`, whose values are `end`: `None` where keys are wrong or its own CRC, if it has one,
    /// differs.
    pub(super) fn read(end: Table, line: &[u8]) -> Option<Self> {
        let end: Self = end.try_into().ok()?;
        let seal = || {
            let sealed = memchr::memmem::rfind(line, END_CRC.as_bytes())?;
            let crc32 = crc32fast::hash(line.get(..sealed)?);
            Some(format!("{crc32:08x}"))
        };
        (end.end_crc32.is_none() || end.end_crc32 == seal()).then_some(end)
    }
}
