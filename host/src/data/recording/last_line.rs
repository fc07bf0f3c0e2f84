//! How a recording ends, and the line that says so.

use super::header::on_one_line;
use servoid_protocol::timing::SAMPLES_PER_FRAME;
use std::ops::Range;
use toml::Table;

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
        let line = match self {
            Self::Complete => {
                format!("# end = \"complete\", rows = {rows}, crc32 = \"{crc32:08x}\"")
            }
            Self::Early { reason } => {
                let reason = on_one_line(&toml::Value::from(reason.as_str()));
                format!(
                    "# end = \"early\", rows = {rows}, crc32 = \"{crc32:08x}\", reason = {reason}"
                )
            }
            Self::Partial {
                reason,
                lost_frames,
            } => {
                let reason = on_one_line(&toml::Value::from(reason.as_str()));
                let samples = |frame: u32| u64::from(frame) * SAMPLES_PER_FRAME as u64;
                let lost: Vec<_> = lost_frames
                    .iter()
                    .filter(|f| !f.is_empty())
                    .map(|f| format!("[{}, {}]", samples(f.start), samples(f.end) - 1))
                    .collect();
                format!(
                    "# end = \"partial\", rows = {rows}, crc32 = \"{crc32:08x}\", reason = {reason}, lost_samples = [{}]",
                    lost.join(", ")
                )
            }
        };
        let own_crc = crc32fast::hash(line.as_bytes());
        format!("{line}{END_CRC}\"{own_crc:08x}\"\n")
    }
}

/// Whether `line`, whose values are `end`, has the keys of a last line and matches its own CRC, if it has
/// one.
pub(super) fn is_as_written(end: &Table, line: &[u8]) -> bool {
    const KEYS: [&str; 6] = [
        "end",
        "rows",
        "crc32",
        "reason",
        "lost_samples",
        "end_crc32",
    ];
    let is_sound = end.get("end_crc32").is_none_or(|crc32| {
        let sealed = memchr::memmem::rfind(line, END_CRC.as_bytes()).and_then(|at| line.get(..at));
        let found = sealed.map(|sealed| format!("{:08x}", crc32fast::hash(sealed)));
        crc32.as_str() == found.as_deref()
    });
    is_sound && end.keys().all(|key| KEYS.contains(&key.as_str()))
}
