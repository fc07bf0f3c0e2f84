//! How a recording ends, and the line that says so.

use super::END_CRC;
use super::header::on_one_line;
use servoid_protocol::framing::CRC;
use servoid_protocol::timing::SAMPLES_PER_FRAME;
use std::ops::Range;

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
        let own_crc = CRC.checksum(line.as_bytes());
        format!("{line}{END_CRC}\"{own_crc:08x}\"\n")
    }
}
