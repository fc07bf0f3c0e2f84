//! `servoid simulate`

use super::capture::{CaptureJob, Monitor, capture, first_partial};
use super::completion_values::simulated_servo;
use super::input;
use super::output::{Output, check_apart};
use super::reference_args::ReferenceArgs;
use crate::analysis::SimulatedServo;
use crate::data::rig_file::RigFile;
use crate::instrument::simulated_servo::{caution, taken_for};
use anyhow::Result;
use clap::{Args, ValueHint};
use std::path::PathBuf;

/// Record a simulated servo, as fast as the computer allows
///
/// The same as 'servoid capture' with --port sim:SERVO?seed=S. The servo of a model is commanded in degrees like the
/// others, 10 µs of the pulse for each: a command in radians follows them, and one in µs is the pulse itself, the
/// column pulse_us of the recording. Where the model's units are not known, 1 is taken for what is
/// said before the run.
#[derive(Debug, Args)]
#[command(after_help = "Examples:
  servoid simulate --servo aircraft --seed 3 -o aircraft.csv
  servoid simulate --servo mine.json --reference stairs --levels 7 -o again.csv
  servoid simulate --servo bench --reference prbs --length 20 -o prbs.csv")]
pub(super) struct Simulate {
    /// The servo: bench (free), aircraft (loaded by a rotor), linear (exactly), or a model of 'servoid identify
    /// --servo-model'
    #[arg(long, value_name = "SERVO|MODEL.json", value_parser = simulated_servo(), hide_possible_values = true)]
    servo: String,
    /// The controller that drives it, where the model has several
    #[arg(long, value_name = "NAME", value_parser = super::value_parsers::finite)]
    controller: Option<f64>,
    /// Seed of the noise; equal seeds give equal recordings [default: 1]
    #[arg(long)]
    seed: Option<u64>,
    /// The recording to write
    #[arg(long, short, value_name = "FILE.csv", value_hint = ValueHint::FilePath)]
    out: PathBuf,
    #[command(flatten)]
    output: Output,
    #[command(flatten)]
    reference: ReferenceArgs,
}

impl Simulate {
    pub(super) fn run(self) -> Result<String> {
        let servo = SimulatedServo {
            servo: &self.servo,
            controller: self.controller,
            seed: self.seed,
        };
        check_apart([&self.out], self.reference.table())?;
        // Before a file is reserved: a servo that there is not is wrong usage.
        let address = servo.address().map_err(input::no_servo)?;
        let (rig, talk) = (RigFile::default(), self.output.talk);
        let remarks = [caution(&self.servo), taken_for(&self.servo)];
        for remark in remarks.into_iter().flatten() {
            talk.say(remark);
        }
        let job = CaptureJob {
            address: &address,
            reference: self.reference.resolve(&rig, talk)?,
            rig,
            condition: &servo.condition(),
            notes: "",
            release: false,
            files: std::slice::from_ref(&self.out),
            force: self.output.force,
            inexact_clock: false,
        };
        let ends = capture(&job, &Monitor::plain(talk), talk)?;
        if let Some(partial) = first_partial(job.files, &ends) {
            return Err(partial.into());
        }
        let rows: u64 = ends.iter().map(|end| end.rows).sum();
        let text = format!("{}: {rows} samples\n", self.out.display());
        talk.result(text, &serde_json::json!({ "file": self.out, "rows": rows }))
    }
}
