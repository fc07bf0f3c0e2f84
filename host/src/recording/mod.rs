//! Recordings: what was commanded and what was measured, sample by sample.
//!
//! ```text
//! # format = 1
//! # servo = "ALIGN DS610"
//! # condition = "bench"
//! # sample_period_s = 0.002
//! # ...
//! sample,time_s,reference_deg,position_deg,counts
//! 0,0.000,0,0.0275,8193
//! 1,0.002,0,-0.0092,8189
//! ...
//! # end = "complete", rows = 4400, crc32 = "5ad0c1f2"
//! ```
//!
//! | part       | rule                                                                                      |
//! |------------|-------------------------------------------------------------------------------------------|
//! | comments   | `# key = value`, the values in TOML                                                        |
//! | rows       | one per sample, appended and handed to the system frame by frame                           |
//! | `sample`   | counts from the first sample of the run; a lost sample is a missing row, never a shifted one |
//! | last line  | how it ended, the number of rows, and the CRC-32 (ISO-HDLC) of their bytes, line ends included |
//!
//! Without its last line a recording is partial, and is read as such. pandas
//! (`read_csv(path, comment="#")`) and MATLAB (`readtable(path, CommentStyle="#")`) read it as it is.

mod header;
mod reader;
mod writer;

pub use header::Header;
pub use reader::{Completeness, ReadError, Recording, is_recording};
pub(crate) use writer::create;
pub use writer::{Ending, RecordingWriter, WriteError};

/// Version of the format; a reader refuses a higher one.
pub const FORMAT: u32 = 1;

/// The header row.
pub const COLUMNS: [&str; 5] = [
    "sample",
    "time_s",
    "reference_deg",
    "position_deg",
    "counts",
];
