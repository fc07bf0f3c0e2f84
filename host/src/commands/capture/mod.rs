//! `servoid capture`

mod monitor;
mod progress_line;
mod runs;
mod until_band;

pub(super) use monitor::Monitor;
pub(super) use runs::{CaptureJob, capture, first_partial};

use super::ctrl_c;
use super::output::{Output, Talk, check_apart, typed_path};
use super::partial_recording::PartialRecording;
use super::reference_args::ReferenceArgs;
use super::rig_args::{Rig, RigArgs};
use crate::data::dataset::{DatasetOptions, load};
use crate::data::numbered_path::with_suffix;
use crate::data::recording::Ending;
use crate::data::{FAR_FROM_COMMAND_DEG, hardly_moved};
use crate::instrument::rig::CaptureEnd;
use anyhow::Result;
use clap::Args;
use monitor::MonitorArgs;
use serde::Serialize;
use std::path::{Path, PathBuf};
use until_band::BandReached;

/// Drive the servo with a reference and record its motion
///
/// A run is 0.8 s at neutral, the reference, and 0.8 s at neutral. Each row is written to the disk as it
/// arrives. Ctrl-C brings the servo to neutral, closes the file and keeps the data, within a second. The exit code
/// is 3 where the recording is partial. After the run the servo
/// is held at neutral, unless --release is given. In a terminal a live scope shows the motion, the link
/// and, from the second cycle on, the step response with its band; q ends the run.
#[derive(Debug, Args)]
#[command(after_help = "Example:
  servoid capture --port /dev/ttyUSB0 --condition bench -o bench.csv
  servoid capture --port sim:aircraft -o aircraft.csv       (no hardware needed)
  servoid capture --port 'sim:bench?realtime' -o live.csv   (in real time, to watch)
  servoid capture --port /dev/ttyUSB0 --until-band 1 -o bench.csv
  servoid capture --port sim:bench --reference stairs --levels 7 -o stairs.csv
  servoid capture --port sim:bench --reference prbs --repeat 2 -o p.csv       (p-1.csv and p-2.csv)")]
pub(super) struct CaptureArgs {
    #[command(flatten)]
    rig: RigArgs,
    /// A remark to keep in the recording
    #[arg(long, default_value = "")]
    notes: String,
    /// End the pulses after the last run: the servo goes limp
    #[arg(long)]
    release: bool,
    /// The recording to write; with --repeat, -1, -2, ... are put before its ending
    #[arg(long, short, value_name = "FILE.csv")]
    out: PathBuf,
    /// Number of runs, each in a recording of its own; 'servoid identify' and 'compare' take them together.
    /// The first run that is not complete is the last one
    #[arg(long, default_value_t = 1, value_name = "COUNT", value_parser = clap::value_parser!(u16).range(1..=MOST_RUNS))]
    repeat: u16,
    #[command(flatten)]
    monitor: MonitorArgs,
    #[command(flatten)]
    output: Output,
    #[command(flatten)]
    reference: ReferenceArgs,
}

/// A larger number is more likely a typing error than an intention.
const MOST_RUNS: i64 = 999;

/// The result as `--json` prints it.
#[derive(Serialize)]
struct CaptureResult<'a> {
    file: &'a Path,
    complete: bool,
    ended_early: bool,
    reason: Option<&'a str>,
    rows: u64,
    moved_percent: Option<f64>,
    unreadable_messages: u32,
    frames_asked_again: u32,
    #[serde(skip_serializing_if = "Option::is_none")]
    until_band: Option<BandReached>,
}

impl CaptureArgs {
    pub(super) fn run(self) -> Result<String> {
        let talk = self.output.talk;
        let source = self.rig.source(talk)?;
        let files = run_files(&self.out, self.repeat);
        check_apart(&files, source.path.iter().chain(self.reference.table()))?;
        let Rig {
            address,
            file: rig,
            condition,
            inexact_clock,
        } = self.rig.require(source.file)?;
        let reference = self.reference.resolve(&rig, talk)?;
        ctrl_c::listen_in_a_run()?;
        let monitor = self.monitor.start(rig.train(), talk);
        let job = CaptureJob {
            address: &address,
            rig,
            reference,
            condition: &condition,
            notes: &self.notes,
            release: self.release,
            files: &files,
            force: self.output.force,
            inexact_clock,
        };
        let ends = capture(&job, &monitor, talk)?;
        report(&self.out, &files, &ends, monitor.band_reached(), talk)
    }
}

/// The file of each run: `out` itself, or for several runs `out` with -1, -2, ... before its ending.
fn run_files(out: &Path, runs: u16) -> Vec<PathBuf> {
    if runs == 1 {
        return vec![out.to_owned()];
    }
    let name = |run: u16| with_suffix(out, &format!("-{run}"));
    (1..=runs).map(name).collect()
}

/// The result: one object for one run, a list of them for several. The band is that of all runs together.
fn report(
    out: &Path,
    files: &[PathBuf],
    ends: &[CaptureEnd],
    until_band: Option<BandReached>,
    talk: Talk,
) -> Result<String> {
    let partial = first_partial(files, ends);
    if let Some(partial) = partial
        && !ctrl_c::asked()
    {
        return Err(partial.into());
    }
    let (mut text, mut results) = (String::new(), Vec::new());
    for (file, end) in files.iter().zip(ends) {
        let (name, rows) = (file.display(), end.rows);
        let (state, reason) = match &end.ending {
            Ending::Complete => ("complete", None),
            Ending::Early { reason } => ("ended early", Some(reason.as_str())),
            Ending::Partial { reason, .. } => ("partial", Some(reason.as_str())),
        };
        let why = reason.map_or_else(String::new, |reason| format!(" ({reason})"));
        text += &format!("{name}: {state}{why}, {rows} samples\n");
        text.extend(end.moved.and_then(standstill));
        text.extend(end.apart_deg.and_then(far_from_command));
        results.push(CaptureResult {
            file,
            complete: matches!(end.ending, Ending::Complete),
            ended_early: matches!(end.ending, Ending::Early { .. }),
            reason,
            rows,
            moved_percent: end.moved.map(|share| 100.0 * share),
            unreadable_messages: end.rejects,
            frames_asked_again: end.asked_again,
            until_band,
        });
    }
    let left_out = files.len() - results.len();
    let enough = results.last().is_some_and(|last| last.ended_early);
    if left_out > 0 {
        let why = match enough {
            true => "the band is narrow enough",
            false => "stopped by the user",
        };
        let runs = if left_out == 1 {
            "run was"
        } else {
            "runs were"
        };
        text += &format!("{why}, so {left_out} {runs} left out\n");
    }
    let advice = until_band.and_then(|band| band.advice(ends.len()));
    text.extend(advice.map(|advice| advice + "\n"));
    let usable = results.iter().filter(|run| has_reference(run));
    let names: Vec<String> = usable.map(|run| typed_path(run.file)).collect();
    let model = typed_path(&out.with_extension("json"));
    text += &match &names[..] {
        [] => NO_REFERENCE.to_owned(),
        some => talk.next(format_args!(
            "servoid identify {} -o {model}",
            some.join(" ")
        )),
    };
    let result = match (files.len(), results.first()) {
        (1, Some(result)) => talk.result(text, result),
        _ => talk.result(text, &serde_json::json!({ "runs": results })),
    }?;
    let all_there = enough || (left_out == 0 && results.iter().all(|run| run.complete));
    match all_there {
        true => Ok(result),
        false => Err(PartialRecording::asked_for(result).into()),
    }
}

/// Said where no run has a sample of its reference.
const NO_REFERENCE: &str =
    "nothing to identify: the run ended before its reference began; capture it again\n";

/// Whether there is anything to identify in a recording: one that was cut short may end before its reference begins.
fn has_reference(run: &CaptureResult<'_>) -> bool {
    run.complete || load(&[run.file.to_owned()], &DatasetOptions::default()).is_ok()
}

/// The warning of a servo that has hardly moved. The recording is kept: it may show why.
fn standstill(share: f64) -> Option<String> {
    hardly_moved(share).then(|| {
        format!(
            "warning: the servo hardly moved: the scatter of its position is {:.0} % of that of the command. Check that it has power, that nothing jams it, that \
             its signal wire is at PA1, that it takes such pulses, that the magnet turns with the shaft, and the scales of the rig file\n",
            100.0 * share
        )
    })
}

/// The warning of a servo that stands far from its command: on a linkage, or with the wrong pulses, that is where it breaks.
fn far_from_command(apart_deg: f64) -> Option<String> {
    (apart_deg.abs() > FAR_FROM_COMMAND_DEG).then(|| {
        format!(
            "warning: the position lies {apart_deg:+.0} degrees from the command on average. Look at the servo before the next run: it may stand at its stop, \
             the rig file may be that of another servo or sensor, or the servo takes other pulses\n"
        )
    })
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
