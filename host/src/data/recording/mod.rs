//! Recordings: the pulse that was applied and the counts that were measured, sample by sample.
//!
//! ```text
//! # format = 3
//! # condition = "bench"
//! # sample_period_s = 0.002
//! # ...
//! # row_checks = true
//! # header_crc32 = "0f6a22d9"
//! sample,time_s,reference_deg,position_deg,pulse_us,counts,check
//! 0,0.000,0,0.0275,1500,8193,3370663066
//! 1,0.002,0,-0.0092,1500,8189,2924911469
//! ...
//! # end = "complete", rows = 4400, crc32 = "5ad0c1f2", end_crc32 = "11c5a6c3"
//! ```
//!
//! | part      | rule                                                                                       |
//! |-----------|--------------------------------------------------------------------------------------------|
//! | comments  | `# key = value`, the values in TOML; the format first, the header's own CRC last           |
//! | rows      | one per sample, appended and handed to the system frame by frame: ten rows of one pulse    |
//! | `sample`  | counts from the first sample of the run; a lost sample is a missing row, never a shifted one |
//! | `pulse_us`, `counts` | the data: the applied pulse width and the raw reading of the sensor              |
//! | `time_s`, `reference_deg`, `position_deg` | for people: they follow from the other columns by the header's period and scales |
//! | `check`   | CRC-32 over the header's own CRC, as it is written, and the row before it: a row of another recording has another one |
//! | last line | how it ended, the number of rows, the CRC of the rows, and last its own CRC                |
//!
//! On reading, the columns for people must be those of the data beside them, so that a changed digit shows
//! where it is; then they are dropped. [`DegreeScale`](crate::data::DegreeScale) makes degrees of the data again.
//!
//! Every CRC is a CRC-32 (ISO-HDLC): the header's over the lines above it, that of the rows over their bytes
//! with their line ends, that of the last line over the text before it.
//!
//! The end is `"complete"`, `"early"` (ended on purpose, with the reason: every sample until then is
//! there) or `"partial"` (with the reason and the lost samples). Without its last line a recording is
//! partial, and is read as such. It is complete when its samples are those of the run in the header, none
//! left out and none named as lost, whatever its last line states.
//!
//! pandas (`read_csv(path, comment="#")`) and MATLAB (`readtable(path, CommentStyle="#")`) read a recording
//! as it is. The line ends of other systems and a byte order mark, which editors put in, are read as if they
//! were not there.
//!
//! Earlier formats are read too. Formats 1 and 2 had the columns
//! `sample,time_s,reference_deg,position_deg,counts`: the pulse is the whole microsecond that commands
//! `reference_deg`. Early files of format 3 had no `check`. Format 1 had no CRC over the header, and early files of format 2 none over the last line.

mod header;
mod last_line;
mod queued_writer;
mod read_error;
mod reader;
mod recover;
mod reference_toml;
mod reserved_file;
mod row;
mod row_text;
mod scan;
mod target;
mod whole_file;
mod write_error;
mod writer;

pub use header::{FORMAT, Header};
pub use last_line::Ending;
pub use queued_writer::QueuedWriter;
pub use read_error::{ReadError, ReadFault};
pub use reader::{Completeness, Recording};
pub use recover::{Recovered, recover};
pub use reference_toml::as_toml;
pub use reserved_file::ReservedFile;
pub use row::{COLUMNS, Row};
pub(crate) use scan::header_as_it_reads;
pub use scan::is_recording;
pub use target::RecordingTarget;
pub(crate) use whole_file::WholeFile;
pub use whole_file::write_file;
pub use write_error::{WriteError, WriteFault};
pub use writer::RecordingWriter;
