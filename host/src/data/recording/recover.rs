//! Saves the sound frames of a damaged recording.
//!
//! Nothing is guessed. A frame is kept when each of its ten rows agrees with itself, the time with the sample
//! number and the degrees with the pulse and the counts, and all have one pulse. A frame with a damaged
//! row is dropped whole and named as lost.

use super::header::{Header, format_of};
use super::last_line::Ending;
use super::read_error::{ReadError, ReadFault};
use super::reader::{Completeness, judge};
use super::row::Row;
use super::scan::scan;
use super::write_error::WriteError;
use super::writer::RecordingWriter;
use servoid_protocol::timing::SAMPLES_PER_FRAME;
use servoid_protocol::{Counts, Frame};
use std::ops::Range;
use std::path::Path;

/// Findings that are listed one by one: the header of the saved recording keeps them.
const MOST_FINDINGS: usize = 20;

/// The sound part of a damaged recording.
#[derive(Clone, Debug)]
pub struct Recovered {
    /// Where it comes from, and in `recovered` the damage.
    pub header: Header,
    /// The sound frames, in order.
    pub frames: Vec<Frame>,
    /// Frames between them of which nothing sound is left.
    pub lost_frames: Vec<Range<u32>>,
    /// The faults, one sentence each.
    pub findings: Vec<String>,
}

/// Finds the sound frames of a file; `path` is what error texts call it.
///
/// # Errors
/// [`ReadFault::Newer`] for a file of a later version, [`ReadFault::NothingSound`] where no frame is left.
pub fn recover(bytes: &[u8], path: &Path) -> Result<Recovered, ReadError> {
    recovered(bytes).map_err(ReadError::at(path))
}

fn recovered(bytes: &[u8]) -> Result<Recovered, ReadFault> {
    let scanned = scan(bytes)?;
    let frames: Vec<Frame> = scanned
        .rows
        .chunk_by(same_frame)
        .filter_map(frame)
        .collect();
    if frames.is_empty() {
        return Err(ReadFault::NothingSound);
    }
    let damages = &scanned.damages;
    let listed = damages.iter().take(MOST_FINDINGS);
    let mut findings: Vec<String> = listed
        .map(|damage| format!("line {}: {}", damage.line, damage.reason))
        .collect();
    if damages.len() > MOST_FINDINGS {
        let more = damages.len() - MOST_FINDINGS;
        findings.push(format!("{more} more findings of this kind"));
    }
    let mut named_lost = Vec::new();
    match judge(&scanned) {
        Ok((completeness, lost)) => {
            named_lost = lost;
            if let Completeness::Partial(why) = completeness {
                findings.push(why);
            }
        }
        Err(what) if damages.is_empty() => {
            findings.push(format!("its rows do not match its last line: {what}"));
        }
        Err(_) => {}
    }
    let mut header = scanned.header;
    // Rows that were read are of this train, by their times.
    let train = header.train_of_rows();
    header.format = format_of(train);
    header.pulse_period_us = train.period_us;
    header.sample_period_s = train.sample_s();
    if !scanned.header_is_sound {
        header.mark_unproved(&proved(&frames, scanned.has_pulse));
        findings.push(format!(
            "the header was damaged, and the rows do not prove these of its values: {}",
            header.unproved
        ));
    }
    header.recovered = findings.join("; ");
    Ok(Recovered {
        lost_frames: lost_frames(&frames, &named_lost),
        header,
        frames,
        findings,
    })
}

/// The values of the header that the rows prove: the period, and as soon as two different counts are there
/// the sensor's scale, by the degrees beside them; likewise the servo's scale, where the pulse has a column.
fn proved(frames: &[Frame], has_pulse: bool) -> Vec<&'static str> {
    let mut proved = vec!["format", "row_checks", "sample_period_s"];
    if differ(frames.iter().flat_map(|frame| frame.samples)) {
        proved.extend(["zero_counts", "degrees_per_count"]);
    }
    if has_pulse && differ(frames.iter().map(|frame| frame.pulse)) {
        proved.extend(["neutral_us", "us_per_degree"]);
    }
    proved
}

fn differ<T: PartialEq>(mut values: impl Iterator<Item = T>) -> bool {
    let first = values.next();
    values.any(|other| Some(other) != first)
}

impl Recovered {
    /// Rows that were saved.
    pub fn rows(&self) -> usize {
        self.frames.len() * SAMPLES_PER_FRAME
    }

    /// Writes a partial recording of the frames that were saved.
    pub fn write(&self, mut writer: RecordingWriter) -> Result<(), WriteError> {
        for frame in &self.frames {
            writer.append(frame)?;
        }
        writer.finish(&Ending::Partial {
            reason: format!("recovered: {}", self.header.recovered),
            lost_frames: self.lost_frames.clone(),
        })
    }
}

fn index(row: &Row) -> u64 {
    row.sample / SAMPLES_PER_FRAME as u64
}

fn same_frame(a: &Row, b: &Row) -> bool {
    index(a) == index(b)
}

fn frame(rows: &[Row]) -> Option<Frame> {
    let first = rows.first()?;
    let counts: Vec<Counts> = rows.iter().map(|row| row.counts).collect();
    // Format 1 does not promise whole frames of one pulse.
    let one_pulse = rows.iter().all(|row| row.pulse == first.pulse);
    Some(Frame {
        run: 0,
        index: u16::try_from(index(first)).ok()?,
        pulse: one_pulse.then_some(first.pulse)?,
        samples: counts.try_into().ok()?,
    })
}

/// The gaps between the frames, and the lost samples behind them that the file itself names.
fn lost_frames(frames: &[Frame], named: &[Range<u64>]) -> Vec<Range<u32>> {
    let mut lost = Vec::new();
    let mut next = 0;
    for frame in frames {
        let index = u32::from(frame.index);
        if next < index {
            lost.push(next..index);
        }
        next = index + 1;
    }
    let samples = SAMPLES_PER_FRAME as u64;
    let behind = named.iter().filter_map(|range| {
        let start = u32::try_from(range.start / samples).ok()?;
        let end = u32::try_from(range.end / samples).ok()?;
        (start >= next && start < end).then_some(start..end)
    });
    lost.extend(behind);
    lost
}
