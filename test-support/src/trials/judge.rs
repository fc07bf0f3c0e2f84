//! A capture into memory, compared with the samples of the board.

use servoid::data::recording::{
    Completeness, Ending, Header, Recording, RecordingTarget, RecordingWriter,
};
use servoid::data::rig_file::RigFile;
use servoid::instrument::port::Port;
use servoid::instrument::rig::CaptureError;
use servoid::instrument::rig::{Capture, RigClient, StopReason};
use servoid_protocol::message::Start;
use servoid_protocol::timing::SAMPLES_PER_FRAME;
use servoid_protocol::{Counts, PulseWidth};
use servoid_simulator::SimulatedFrame;
use std::io::{Result as IoResult, Write};
use std::path::Path;
use std::sync::{Arc, Mutex};

/// How a trial went. Each is checked before it is returned: a trial that is silently wrong is an
/// `Err` that describes it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// Every sample.
    Complete,
    /// Some samples, with the missing ones listed.
    Partial,
    /// No recording, with the reason.
    Refused,
}

/// A file in memory, of which the test keeps the other end, on a disk that has room for so much.
#[derive(Clone)]
pub struct Memory {
    bytes: Arc<Mutex<Vec<u8>>>,
    room: usize,
}

impl Write for Memory {
    fn write(&mut self, bytes: &[u8]) -> IoResult<usize> {
        let mut disk = self.bytes.lock().unwrap();
        let count = bytes.len().min(self.room - disk.len());
        disk.extend(bytes.iter().take(count));
        if count == 0 {
            return Err(std::io::ErrorKind::StorageFull.into());
        }
        Ok(count)
    }

    fn flush(&mut self) -> IoResult<()> {
        Ok(())
    }
}

impl RecordingTarget for Memory {
    fn cut_to(&mut self, length: u64) -> IoResult<()> {
        self.bytes.lock().unwrap().truncate(length as usize);
        Ok(())
    }

    fn settle(&mut self) -> IoResult<()> {
        Ok(())
    }
}

/// Captures `start` over `port` to a disk with `room` for so many bytes; what the capture itself
/// reports, and what is on the disk.
pub fn capture_to_disk(
    port: Box<dyn Port>,
    start: Start,
    should_stop: &dyn Fn() -> bool,
    room: usize,
) -> (Result<Ending, CaptureError>, Option<Vec<u8>>) {
    let bytes = Arc::default();
    let memory = Memory { bytes, room };
    let rig = RigFile::default();
    let capture = Capture { rig, start };
    // Each run in a session of its own: a rig that is kept on may have heard of the one before.
    let prepared = RigClient::connect_as(port, "the line", start.run).and_then(|mut client| {
        capture.arm(&mut client)?;
        Ok(client)
    });
    let mut client = match prepared {
        Ok(client) => client,
        Err(error) => return (Err(error.into()), None),
    };
    let header = Header {
        started: String::new(),
        ..Header::of_run(client.hello(), &capture.rig, &start)
    };
    let writer = RecordingWriter::on(Box::new(memory.clone()), Path::new("x.csv"), &header)
        .expect("there is room for the header");
    let stop = || should_stop().then_some(StopReason::User);
    let end = capture.record(&mut client, writer, &stop, &mut |_| ());
    let bytes = memory.bytes.lock().unwrap().clone();
    (end.map(|end| end.ending), Some(bytes))
}

/// Compares the recording with the samples of the board; returns its class.
///
/// `frames_total` is the length of the whole run; `log` is the board's own, in order, and the run may be
/// anywhere in it.
pub fn check(
    bytes: &[u8],
    frames_total: u32,
    ending: Option<&Ending>,
    log: &[SimulatedFrame],
) -> Result<Outcome, String> {
    let recording = Recording::parse(bytes, Path::new("x.csv")).map_err(|e| e.to_string())?;
    let frames = frames(&recording)?;
    require_truth(&frames, log)?;
    // A file that could not be closed has no line to name anything in.
    let closed = bytes.windows(9).any(|place| place == b"\n# end = ");
    let gaps = gaps(&frames, if closed { frames_total.into() } else { 0 });
    let named: Vec<_> = recording
        .lost_samples
        .iter()
        .map(|r| r.start / SAMPLES_PER_FRAME as u64..r.end / SAMPLES_PER_FRAME as u64)
        .collect();
    if !gaps.iter().all(|gap| named.contains(gap)) {
        return Err(format!("missing {gaps:?}, and only {named:?} is named"));
    }
    let whole = frames.len() as u32 == frames_total && gaps.is_empty();
    match (&recording.completeness, ending) {
        (Completeness::Complete, Some(Ending::Complete)) if whole => Ok(Outcome::Complete),
        (Completeness::Partial(reason), None | Some(Ending::Partial { .. }))
            if !reason.is_empty() =>
        {
            Ok(Outcome::Partial)
        }
        (found, said) => Err(format!(
            "the file is {found:?} with {} frames, the capture said {said:?}",
            frames.len()
        )),
    }
}

/// Whether all rows are the board's, at one and the same place of its log.
///
/// # Errors
/// How they differ.
pub fn require_board_rows(recording: &Recording, log: &[SimulatedFrame]) -> Result<(), String> {
    require_truth(&frames(recording)?, log)
}

/// Number, pulse and counts of one frame.
type Read = (u64, PulseWidth, Vec<Counts>);

fn frames(recording: &Recording) -> Result<Vec<Read>, String> {
    let frames = recording.rows.chunks(SAMPLES_PER_FRAME);
    let read = frames.map(|rows| {
        let [first, ..] = rows else { return None };
        let counts = rows.iter().map(|row| row.counts).collect();
        let number = first.sample / SAMPLES_PER_FRAME as u64;
        (rows.len() == SAMPLES_PER_FRAME).then_some((number, first.pulse, counts))
    });
    let read: Option<Vec<Read>> = read.collect();
    read.ok_or_else(|| "the rows are no whole frames".to_owned())
}

/// All frames are the board's, at one and the same place of its log.
fn require_truth(frames: &[Read], log: &[SimulatedFrame]) -> Result<(), String> {
    let same = |(number, pulse, counts): &Read, offset: usize| {
        log.get(offset + *number as usize)
            .is_some_and(|truth| truth.samples[..] == counts[..] && truth.pulse == Some(*pulse))
    };
    let fits = |offset: &usize| frames.iter().all(|frame| same(frame, *offset));
    if frames.is_empty() || (0..log.len()).any(|offset| fits(&offset)) {
        Ok(())
    } else {
        Err("rows differ from what the board sampled".to_owned())
    }
}

/// The missing frames between the others, and after them up to `end`.
fn gaps(frames: &[Read], end: u64) -> Vec<std::ops::Range<u64>> {
    let mut next = 0;
    let mut gaps = Vec::new();
    for (number, ..) in frames {
        if next < *number {
            gaps.push(next..*number);
        }
        next = number + 1;
    }
    if next < end {
        gaps.push(next..end);
    }
    gaps
}
