//! `servoid capture`

use super::watch::{BandReached, Watch, WatchArgs};
use super::{Talk, interrupt};
use crate::port;
use crate::recording::{Ending, Header, ReservedFile};
use crate::rig::{Capture, CaptureEnd, RigClient, RigFile};
use anyhow::{Context, Result, bail};
use clap::{Args, ValueEnum};
use serde::Serialize;
use servoid_protocol::message::Command;
use servoid_protocol::reference::{Reference, Staircase};
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
  servoid capture --port /dev/ttyUSB0 --until-band 1 -o bench.csv")]
pub(super) struct CaptureArgs {
    /// Where the rig is: a serial device, tcp:HOST:PORT, or sim:bench, sim:aircraft, sim:linear
    /// (sim:bench?realtime&seed=7 for real pace and another noise)
    #[arg(long, short)]
    port: Option<String>,
    /// What is known of servo and sensor; without it: 1500 µs neutral, 10 µs per degree, a Honeywell
    /// RTY sensor of 120 degrees
    #[arg(long, value_name = "RIG.toml")]
    rig: Option<PathBuf>,
    /// What the servo is told
    #[arg(long, value_enum, default_value_t = ReferenceKind::Staircase)]
    reference: ReferenceKind,
    /// How far the reference goes to each side (degrees)
    #[arg(
        long,
        default_value_t = 5.0,
        value_name = "DEGREES",
        allow_negative_numbers = true
    )]
    amplitude: f64,
    /// Under what condition: bench, aircraft, or a word of your own
    #[arg(long, default_value = "")]
    condition: String,
    /// I have read the safety rules, and nobody is near the rotor (needed for every condition but
    /// bench)
    #[arg(long)]
    arm: bool,
    /// A remark that the recording keeps
    #[arg(long, default_value = "")]
    notes: String,
    /// End the pulses after the run: the servo goes limp
    #[arg(long)]
    release: bool,
    /// The recording to write
    #[arg(long, short, value_name = "FILE.csv")]
    out: PathBuf,
    /// Replace the file if it exists
    #[arg(long)]
    force: bool,
    #[command(flatten)]
    watch: WatchArgs,
    #[command(flatten)]
    talk: Talk,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum ReferenceKind {
    /// The paper's: holds of 800 ms down to 100 ms by 100 ms, each at + and at - (7.2 s)
    Staircase,
}

/// What is captured, from where, and what is done to the rig afterwards.
pub(super) struct Job<'a> {
    pub address: &'a str,
    pub rig: RigFile,
    pub amplitude_deg: f64,
    pub condition: &'a str,
    pub notes: &'a str,
    pub release: bool,
    pub out: &'a Path,
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
        let rig = match &self.rig {
            Some(path) => RigFile::read(path)?,
            None => RigFile::default(),
        };
        let Some(address) = self.port.clone().or_else(|| rig.port.clone()) else {
            bail!(
                "say where the rig is, with --port or with 'port' in the rig file: 'servoid ports' lists the serial ports, and sim:bench needs none"
            );
        };
        // Any condition that is not plainly the bench may be a loaded servo.
        let condition = self.condition.trim().to_lowercase();
        let on_the_bench = condition.is_empty() || condition.starts_with("bench");
        let dangerous = !on_the_bench && !port::is_simulated(&address);
        if dangerous && !self.arm {
            bail!(
                "the condition {:?} may move a loaded servo: read the safety rules in the README, clear the rotor, then add --arm",
                self.condition
            );
        }
        let ReferenceKind::Staircase = self.reference;
        interrupt::listen()?;
        let watch = self.watch.watch(self.talk);
        let end = capture(
            &Job {
                address: &address,
                rig,
                amplitude_deg: self.amplitude,
                condition: &self.condition,
                notes: &self.notes,
                release: self.release,
                out: &self.out,
                force: self.force,
            },
            &watch,
            self.talk,
        )?;
        self.report(&end, watch.band_reached())
    }

    fn report(&self, end: &CaptureEnd, until_band: Option<BandReached>) -> Result<String> {
        let (state, reason) = match &end.ending {
            Ending::Complete => ("complete", None),
            Ending::Early { reason } => ("ended early", Some(reason.as_str())),
            Ending::Partial { reason, .. } => ("partial", Some(reason.as_str())),
        };
        let advice = until_band.as_ref().and_then(BandReached::advice);
        if state == "partial"
            && let Some(reason) = reason
            && !interrupt::asked()
        {
            bail!(
                "{} is partial, {} samples: {reason}",
                self.out.display(),
                end.rows
            );
        }
        let result = CaptureResult {
            file: &self.out,
            complete: state == "complete",
            ended_early: state == "ended early",
            reason,
            rows: end.rows,
            unreadable_messages: end.rejects,
            frames_asked_again: end.asked_again,
            until_band,
        };
        let why = reason.map_or_else(String::new, |reason| format!(" ({reason})"));
        let advice = advice.map_or_else(String::new, |advice| advice + "\n");
        let (file, rows) = (self.out.display(), end.rows);
        self.talk.result(
            format!("{file}: {state}{why}, {rows} samples\n{advice}"),
            &result,
        )
    }
}

/// Below this, rounding to whole microseconds alone is more than 5 % of the step (µs).
const SMALL_AMPLITUDE_US: f64 = 10.0;

/// The paper's staircase at this amplitude.
fn staircase(rig: &RigFile, amplitude_deg: f64, talk: Talk) -> Result<Reference> {
    let microseconds = (amplitude_deg * rig.servo.us_per_degree).abs().round();
    if !(1.0..=1000.0).contains(&microseconds) {
        bail!(
            "an amplitude of {amplitude_deg} degrees is {microseconds} µs of pulse: choose one between 1 and 1000 µs"
        );
    }
    if microseconds < SMALL_AMPLITUDE_US {
        talk.say(format_args!(
            "an amplitude of {amplitude_deg} degrees is only {microseconds} µs of pulse: the step is sent in whole microseconds, and friction and dead band may swallow much of it"
        ));
    }
    let staircase = Staircase {
        amplitude_us: microseconds as u16,
        ..Staircase::PAPER
    };
    Ok(Reference::Staircase(staircase))
}

/// Captures one run.
pub(super) fn capture(job: &Job<'_>, watch: &Watch, talk: Talk) -> Result<CaptureEnd> {
    let capture = Capture::new(
        job.rig.clone(),
        staircase(&job.rig, job.amplitude_deg, talk)?,
    );
    // Before the servo moves, not after: a run may be expensive.
    let file = ReservedFile::new(job.out, job.force)?;
    let mut client = RigClient::connect(port::open(job.address)?, job.address)?;
    let hello = *client.hello();
    talk.say(format_args!(
        "{}: {}, firmware {}, {} clock",
        job.address,
        hello.board.as_str(),
        hello.build.as_str(),
        format!("{:?}", hello.clock).to_lowercase()
    ));
    capture.arm(&mut client)?;
    let header = Header {
        condition: job.condition.to_owned(),
        notes: job.notes.to_owned(),
        port: job.address.to_owned(),
        ..Header::of_run(&hello, &job.rig, &capture.start)
    };
    let writer = file.begin(&header)?;
    let title = format!("{}  to {}", job.address, job.out.display());
    let watched = watch.begin(title, &capture, client.is_paced_by_reader())?;
    let end = capture.record(&mut client, writer, &|| watched.stop(), &mut |p| {
        watched.update(p)
    });
    watched.finish();
    let released = if job.release {
        client.request(Command::Disarm)
    } else {
        Ok(())
    };
    // What went wrong first is what the user has to know.
    let end =
        end.with_context(|| format!("{} keeps what was captured before this", job.out.display()))?;
    released.context("the pulses could not be ended")?;
    Ok(end)
}
