//! The reasons why a recording cannot be read.

use super::header::FORMAT;
use crate::data::file_error::FileError;

/// Why a recording could not be read.
pub type ReadError = FileError<ReadFault>;

/// A fault in a recording.
#[derive(Debug, thiserror::Error)]
pub enum ReadFault {
    /// The error of the system.
    #[error("cannot be read: {0}")]
    Unreadable(std::io::Error),
    /// A later version, which has this format, wrote it.
    #[error(
        "was made by a newer servoid (format {0}, this one reads up to {FORMAT}): update servoid"
    )]
    Newer(u32),
    /// A comment line is damaged: number from 1, and reason.
    #[error(
        "is damaged above its rows, at line {line}: {reason}; {}with --input reference_deg --output position_deg its rows are read as they are",
        recover_if(*.sound_rows)
    )]
    DamagedHeader {
        /// Line, from 1.
        line: usize,
        /// The fault.
        reason: String,
        /// Whether some of its rows are sound.
        sound_rows: bool,
    },
    /// A row is damaged.
    #[error(
        "is damaged at row {row} (line {line}): {reason}; {}with --input reference_deg --output position_deg its rows are read as they are",
        recover_if(*.sound_rows)
    )]
    DamagedRow {
        /// Row, from 1.
        row: usize,
        /// Line, from 1.
        line: usize,
        /// The fault.
        reason: String,
        /// Whether some of the others are sound.
        sound_rows: bool,
    },
    /// Not one frame is sound.
    #[error("has no sound frame left: nothing can be recovered from it")]
    NothingSound,
    /// Every row reads well, and yet rows are not as they were written, for this reason.
    #[error(
        "was changed after it was recorded: its rows do not match its last line ({0}); if you meant to, 'servoid recover' makes a partial recording of it"
    )]
    Changed(&'static str),
}

/// Advice to recover a recording, where there is something to recover.
fn recover_if(sound_rows: bool) -> &'static str {
    match sound_rows {
        true => "'servoid recover' keeps what is sound, and ",
        false => "",
    }
}
