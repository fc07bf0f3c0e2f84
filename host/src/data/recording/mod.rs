//! Recordings: what was commanded and what was measured, sample by sample.
//!
//! ```text
//! # format = 2
//! # condition = "bench"
//! # sample_period_s = 0.002
//! # ...
//! # header_crc32 = "0f6a22d9"
//! sample,time_s,reference_deg,position_deg,counts
//! 0,0.000,0,0.0275,8193
//! 1,0.002,0,-0.0092,8189
//! ...
//! # end = "complete", rows = 4400, crc32 = "5ad0c1f2", end_crc32 = "11c5a6c3"
//! ```
//!
//! | part       | rule                                                                                      |
//! |------------|-------------------------------------------------------------------------------------------|
//! | comments   | `# key = value`, the values in TOML; the format first, the header's own CRC last          |
//! | rows       | one per sample, appended and handed to the system frame by frame: ten rows of one pulse   |
//! | `sample`   | counts from the first sample of the run; a lost sample is a missing row, never a shifted one |
//! | `time_s`   | `sample` times the period; `position_deg` is `counts` on the header's scale               |
//! | last line  | how it ended, the number of rows, the CRC of the rows, and last its own CRC               |
//!
//! Times and positions are said twice, so that a changed digit shows where it is. Every CRC is a CRC-32
//! (ISO-HDLC): the header's over the lines above it, that of the rows over their bytes with their line ends,
//! that of the last line over what stands before it there.
//!
//! The end is `"complete"`, `"early"` (ended on purpose, with the reason: every sample until then is
//! there) or `"partial"` (with the reason and the lost samples).
//!
//! Without its last line a recording is partial, and is read as such. pandas
//! (`read_csv(path, comment="#")`) and MATLAB (`readtable(path, CommentStyle="#")`) read it as it is.
//!
//! A recording counts as complete when its samples are those of the run that the header tells of, none left
//! out and none named as lost, whatever the last line says. Line ends of another system and a byte order
//! mark, as editors put them in, are read as if they were not there.
//!
//! Format 1 had no CRC over the header, and early files of format 2 none over the last line; they are read
//! too.

mod ending;
mod exact;
mod header;
mod reader;
mod recover;
mod reference_toml;
mod reserved;
mod row;
mod scan;
mod write_error;
mod writer;

pub use ending::Ending;
pub use header::Header;
pub use reader::{Completeness, ReadError, Recording, is_recording};
pub use recover::{Recovered, recover};
pub use reference_toml::as_toml;
pub use reserved::ReservedFile;
pub(crate) use reserved::WholeFile;
pub use write_error::WriteError;
pub use writer::{RecordingWriter, Target};

/// Version of the format; a reader refuses a higher one.
pub const FORMAT: u32 = 2;

/// What comes before the last line's own CRC in it.
const END_CRC: &str = ", end_crc32 = ";

/// The header row.
pub const COLUMNS: [&str; 5] = [
    "sample",
    "time_s",
    "reference_deg",
    "position_deg",
    "counts",
];
