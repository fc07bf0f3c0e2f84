//! Runs on a rig, one after the other, each into a recording.

use super::monitor::Monitor;
use crate::commands::ctrl_c;
use crate::commands::output::Talk;
use crate::commands::partial_recording::PartialRecording;
use crate::commands::rig_args::require_clock;
use crate::commands::rig_remarks::delay_of_virtual_board;
use crate::data::recording::{Ending, Header, RecordingWriter, ReservedFile};
use crate::data::rig_file::RigFile;
use crate::instrument::port;
use crate::instrument::rig::{Capture, CaptureEnd, CaptureError, RigClient};
use anyhow::{Context, Result};
use servoid_protocol::message::Command;
use servoid_protocol::reference::Reference;
use std::path::{Path, PathBuf};

/// One or more runs on one rig.
pub(in crate::commands) struct CaptureJob<'a> {
    pub address: &'a str,
    pub rig: RigFile,
    pub reference: Reference,
    pub condition: &'a str,
    pub notes: &'a str,
    /// Whether the pulses end after the last run.
    pub release: bool,
    /// One for each run.
    pub files: &'a [PathBuf],
    pub force: bool,
    /// Whether a board may be used that runs on its internal oscillator.
    pub inexact_clock: bool,
}

/// Captures the runs one after the other, up to the first one that is not complete.
pub(in crate::commands) fn capture(
    job: &CaptureJob<'_>,
    monitor: &Monitor,
    talk: Talk,
) -> Result<Vec<CaptureEnd>> {
    // The board refuses a reference beyond its limits, too. This check comes first: it names the numbers and leaves no file behind.
    job.rig.require_within_limits(&job.reference)?;
    // Before the servo moves: a run may be expensive.
    let reserve = |path: &PathBuf| ReservedFile::new(path, job.force);
    let files: Vec<_> = job.files.iter().map(reserve).collect::<Result<_, _>>()?;
    let mut client = RigClient::connect_beside(port::open(job.address)?, job.address)?;
    let hello = client.hello();
    require_clock(job.inexact_clock, hello)?;
    let (board, build) = (hello.board.as_str(), hello.build.as_str());
    let clock = format!("{:?}", hello.clock).to_lowercase();
    let address = job.address;
    talk.say(format_args!(
        "{address}: {board}, firmware {build}, {clock} clock"
    ));
    if let Some(remark) = delay_of_virtual_board(hello, &job.rig) {
        talk.say(remark);
    }
    let mut ends = Vec::new();
    let mut outcome = Ok(());
    for (file, path) in files.into_iter().zip(job.files) {
        match capture_run(job, &mut client, file, path, monitor) {
            Ok(end) => ends.push(end),
            Err(error) => outcome = Err(after(ends.len(), error)),
        }
        let complete = ends.last().map(|end| &end.ending) == Some(&Ending::Complete);
        if outcome.is_err() || !complete || ctrl_c::asked() {
            break;
        }
    }
    let released = match job.release {
        true => client.request(Command::Disarm),
        false => Ok(()),
    };
    ctrl_c::leaves_partial(outcome.is_err() || first_partial(job.files, &ends).is_some());
    // The first failure is the one to report.
    outcome?;
    released.context("the servo still gets pulses: the request to end them failed")?;
    Ok(ends)
}

/// The failure of a run after `complete` others: part of what was asked for is there.
fn after(complete: usize, error: anyhow::Error) -> anyhow::Error {
    match complete {
        0 => error,
        count => PartialRecording::named(format!("{error:#} ({count} complete before it)")).into(),
    }
}

/// What is missing in the first recording that is not whole, if one is not.
pub(in crate::commands) fn first_partial(
    files: &[PathBuf],
    ends: &[CaptureEnd],
) -> Option<PartialRecording> {
    files
        .iter()
        .zip(ends)
        .enumerate()
        .find_map(|(number, (file, end))| {
            let Ending::Partial { reason, .. } = &end.ending else {
                return None;
            };
            let before = match number {
                0 => String::new(),
                count => format!(" ({count} complete before it)"),
            };
            let (name, rows) = (file.display(), end.rows);
            let sentence = format!("{name} is partial, {rows} samples: {reason}{before}");
            Some(PartialRecording::named(sentence))
        })
}

/// Captures one run.
fn capture_run(
    job: &CaptureJob<'_>,
    client: &mut RigClient,
    file: ReservedFile,
    path: &Path,
    monitor: &Monitor,
) -> Result<CaptureEnd> {
    let capture = Capture::new(job.rig.clone(), job.reference);
    capture.arm(client)?;
    let header = Header {
        condition: job.condition.to_owned(),
        notes: job.notes.to_owned(),
        port: job.address.to_owned(),
        ..Header::of_run(client.hello(), &job.rig, &capture.start)
    };
    let writer = RecordingWriter::begin(file, &header);
    let title = format!("{}  to {}", job.address, path.display());
    let run = monitor.begin(title, &capture, client.is_paced_by_reader())?;
    let mut kept = false;
    let end = capture.record(client, writer, &|| run.stop(), &mut |p| {
        kept = true;
        ctrl_c::leaves_partial(true);
        run.update(p);
    });
    run.finish();
    end.map_err(|error| match error {
        CaptureError::Write(error) if error.fault.rows_kept() > 0 => {
            PartialRecording::named(error.to_string()).into()
        }
        CaptureError::Write(error) => error.into(),
        error if kept => PartialRecording::named(format!(
            "{} keeps all rows up to the failure: {error}",
            path.display()
        ))
        .into(),
        error => error.into(),
    })
}
