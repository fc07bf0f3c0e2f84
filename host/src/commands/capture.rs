//! `servoid capture`

use super::reference_args::ReferenceArgs;
use super::rig_args::{Rig, RigArgs};
use super::watch::{BandReached, Watch, WatchArgs};
use super::{Talk, interrupt};
use crate::data::recording::{Ending, Header, RecordingWriter, ReservedFile, WriteError};
use crate::data::rig_file::RigFile;
use crate::instrument::port;
use crate::instrument::rig::capture::CaptureError;
use crate::instrument::rig::{Capture, CaptureEnd, RigClient};
use anyhow::{Context, Result, bail};
use clap::Args;
use serde::Serialize;
use servoid_protocol::message::Command;
use servoid_protocol::reference::Reference;
use std::path::{Path, PathBuf};

/// Drive the servo with a reference and record how it moves
///
/// The run is: 0.8 s at neutral, the reference, 0.8 s at neutral. Rows are on the disk as they come
/// in; Ctrl-C brings the servo to neutral, closes the file and keeps the data. Afterwards the servo
/// is held at neutral, unless --release is given. In a terminal a live scope shows the motion, the
/// link and, from the second cycle on, the step response with its band; q ends the run.
#[derive(Debug, Args)]
#[command(after_help = "Example:
  servoid capture --port /dev/ttyUSB0 --condition bench -o bench.csv
  servoid capture --port sim:aircraft -o aircraft.csv       (no hardware needed)
  servoid capture --port 'sim:bench?realtime' -o live.csv   (at real pace, to look at)
  servoid capture --port /dev/ttyUSB0 --until-band 1 -o bench.csv
  servoid capture --port sim:bench --reference stairs --levels 7 -o stairs.csv
  servoid capture --port sim:bench --reference prbs --repeat 2 -o p.csv       (p-1.csv and p-2.csv)")]
pub(super) struct CaptureArgs {
    #[command(flatten)]
    rig: RigArgs,
    /// A remark that the recording keeps
    #[arg(long, default_value = "")]
    notes: String,
    /// End the pulses after the run: the servo goes limp
    #[arg(long)]
    release: bool,
    /// The recording to write; with --repeat, -1, -2, ... are put before its ending
    #[arg(long, short, value_name = "FILE.csv")]
    out: PathBuf,
    /// So many runs one after the other, each a recording of its own: 'servoid identify' and 'compare'
    /// take them as several runs. The first one that is not complete is the last one
    #[arg(long, default_value_t = 1, value_name = "COUNT", value_parser = clap::value_parser!(u16).range(1..=MOST_RUNS))]
    repeat: u16,
    /// Replace the file if it exists
    #[arg(long)]
    force: bool,
    #[command(flatten)]
    watch: WatchArgs,
    #[command(flatten)]
    talk: Talk,
    #[command(flatten)]
    reference: ReferenceArgs,
}

/// Beyond this a slip is more likely than an intention.
const MOST_RUNS: i64 = 999;

/// What is captured, from where, and what is done to the rig afterwards.
pub(super) struct Job<'a> {
    pub address: &'a str,
    pub rig: RigFile,
    pub reference: Reference,
    pub condition: &'a str,
    pub notes: &'a str,
    pub release: bool,
    /// One for each run.
    pub files: &'a [PathBuf],
    pub force: bool,
}

/// The result as `--json` prints it.
#[derive(Serialize)]
struct CaptureResult<'a> {
    file: &'a Path,
    complete: bool,
    ended_early: bool,
    reason: Option<&'a str>,
    rows: u64,
    unreadable_messages: u32,
    frames_asked_again: u32,
    #[serde(skip_serializing_if = "Option::is_none")]
    until_band: Option<BandReached>,
}

impl CaptureArgs {
    pub(super) fn run(self) -> Result<String> {
        let Rig {
            address,
            file: rig,
            condition,
        } = self.rig.require()?;
        let reference = self.reference.grant(rig.servo.us_per_degree, self.talk)?;
        let files = run_files(&self.out, self.repeat);
        interrupt::listen()?;
        let watch = self.watch.watch(self.talk);
        let ends = capture(
            &Job {
                address: &address,
                rig,
                reference,
                condition: &condition,
                notes: &self.notes,
                release: self.release,
                files: &files,
                force: self.force,
            },
            &watch,
            self.talk,
        )?;
        report(&files, &ends, watch.band_reached(), self.talk)
    }
}

/// Where each run goes: `out` itself, or for several `out` with -1, -2, ... before its ending.
fn run_files(out: &Path, runs: u16) -> Vec<PathBuf> {
    if runs == 1 {
        return vec![out.to_owned()];
    }
    let name = |run: u16| {
        let mut name = out.file_stem().unwrap_or_default().to_owned();
        name.push(format!("-{run}"));
        if let Some(ending) = out.extension() {
            name.push(".");
            name.push(ending);
        }
        out.with_file_name(name)
    };
    (1..=runs).map(name).collect()
}

/// The result: one object for one run, a list of them for several. The band is that of all of them
/// together.
fn report(
    files: &[PathBuf],
    ends: &[CaptureEnd],
    until_band: Option<BandReached>,
    talk: Talk,
) -> Result<String> {
    let (mut text, mut results) = (String::new(), Vec::new());
    for (file, end) in files.iter().zip(ends) {
        let (state, reason) = match &end.ending {
            Ending::Complete => ("complete", None),
            Ending::Early { reason } => ("ended early", Some(reason.as_str())),
            Ending::Partial { reason, .. } => ("partial", Some(reason.as_str())),
        };
        if state == "partial"
            && let Some(reason) = reason
            && !interrupt::asked()
        {
            bail!(
                "{} is partial, {} samples: {reason}{}",
                file.display(),
                end.rows,
                runs_before(&results)
            );
        }
        let why = reason.map_or_else(String::new, |reason| format!(" ({reason})"));
        text += &format!("{}: {state}{why}, {} samples\n", file.display(), end.rows);
        results.push(CaptureResult {
            file,
            complete: state == "complete",
            ended_early: state == "ended early",
            reason,
            rows: end.rows,
            unreadable_messages: end.rejects,
            frames_asked_again: end.asked_again,
            until_band,
        });
    }
    if results.len() < files.len() && results.last().is_some_and(|last| last.ended_early) {
        let spared = files.len() - results.len();
        text += &format!("the band is narrow enough: {spared} more runs were not needed\n");
    }
    if let Some(advice) = until_band.and_then(|band| band.advice(ends.len())) {
        text += &(advice + "\n");
    }
    match (files.len(), results.first()) {
        (1, Some(result)) => talk.result(text, result),
        _ => talk.result(text, &serde_json::json!({ "runs": results })),
    }
}

fn runs_before(results: &[CaptureResult<'_>]) -> String {
    match results.len() {
        0 => String::new(),
        count => format!(" ({count} complete before it)"),
    }
}

/// Captures the runs one after the other, up to the first one that is not complete.
pub(super) fn capture(job: &Job<'_>, watch: &Watch, talk: Talk) -> Result<Vec<CaptureEnd>> {
    require_within_limits(job)?;
    // Before the servo moves, not after: a run may be expensive.
    let reserve = |path: &PathBuf| ReservedFile::new(path, job.force);
    let files: Vec<_> = job.files.iter().map(reserve).collect::<Result<_, _>>()?;
    let mut client = RigClient::connect_beside(port::open(job.address)?, job.address)?;
    let hello = client.hello();
    talk.say(format_args!(
        "{}: {}, firmware {}, {} clock",
        job.address,
        hello.board.as_str(),
        hello.build.as_str(),
        format!("{:?}", hello.clock).to_lowercase()
    ));
    let mut ends = Vec::new();
    let mut outcome = Ok(());
    for (file, path) in files.into_iter().zip(job.files) {
        match capture_run(job, &mut client, file, path, watch) {
            Ok(end) => ends.push(end),
            Err(error) => outcome = Err(error),
        }
        let complete = ends.last().map(|end| &end.ending) == Some(&Ending::Complete);
        if outcome.is_err() || !complete || interrupt::asked() {
            break;
        }
    }
    let released = if job.release {
        client.request(Command::Disarm)
    } else {
        Ok(())
    };
    // What went wrong first is what the user has to know.
    outcome?;
    released.context("the pulses could not be ended")?;
    Ok(ends)
}

/// The board refuses what leaves the limits; said here, it leaves no file behind and names the numbers.
fn require_within_limits(job: &Job<'_>) -> Result<()> {
    let (low, high) = job.reference.extremes_us();
    let neutral = i32::from(job.rig.servo.neutral_us);
    let [lowest, highest] = [low, high].map(|offset| neutral + i32::from(offset));
    let limits = &job.rig.limits;
    let [shortest, longest] = [limits.shortest_us, limits.longest_us];
    if lowest < i32::from(shortest) || highest > i32::from(longest) {
        bail!(
            "the reference goes from {lowest} to {highest} µs, beyond the rig's limits of {shortest} to {longest} µs: make --amplitude smaller, or widen the limits in the rig file if the servo can take it"
        );
    }
    Ok(())
}

/// Captures one run.
fn capture_run(
    job: &Job<'_>,
    client: &mut RigClient,
    file: ReservedFile,
    path: &Path,
    watch: &Watch,
) -> Result<CaptureEnd> {
    let capture = Capture::new(job.rig.clone(), job.reference);
    capture.arm(client)?;
    let header = Header {
        condition: job.condition.to_owned(),
        notes: job.notes.to_owned(),
        port: job.address.to_owned(),
        ..Header::of_run(client.hello(), &job.rig, &capture.start)
    };
    let writer = RecordingWriter::begin(file, &header)?;
    let title = format!("{}  to {}", job.address, path.display());
    let watched = watch.begin(title, &capture, client.is_paced_by_reader())?;
    let mut kept = false;
    let end = capture.record(client, writer, &|| watched.stop(), &mut |p| {
        kept = true;
        watched.update(p);
    });
    watched.finish();
    match end {
        Err(
            error @ CaptureError::Write(WriteError::Removed { .. } | WriteError::Rescued { .. }),
        ) => Err(error.into()),
        Err(error) if kept => Err(error)
            .with_context(|| format!("{} keeps what was captured before this", path.display())),
        other => Ok(other?),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn several_runs_are_numbered_before_the_ending() {
        let names = |out: &str, runs| run_files(Path::new(out), runs);
        assert_eq!(names("a/rec.csv", 1), [PathBuf::from("a/rec.csv")]);
        let expected = ["a/rec-1.csv", "a/rec-2.csv"].map(PathBuf::from);
        assert_eq!(names("a/rec.csv", 2), expected);
        assert_eq!(names("a.b/rec", 2)[1], PathBuf::from("a.b/rec-2"));
    }
}
