//! `servoid simulate`

use super::capture::{CaptureJob, Monitor, capture};
use super::output::Output;
use super::reference_args::ReferenceArgs;
use crate::data::rig_file::RigFile;
use anyhow::Result;
use clap::{Args, ValueEnum, ValueHint};
use std::path::PathBuf;

/// Record a simulated servo, as fast as the computer allows
///
/// The same as 'servoid capture' with --port sim:SERVO?seed=S.
#[derive(Debug, Args)]
#[command(after_help = "Examples:
  servoid simulate --servo aircraft --seed 3 -o aircraft.csv
  servoid simulate --servo bench --reference prbs --length 20 -o prbs.csv")]
pub(super) struct Simulate {
    /// The servo: free on the bench, loaded by a rotor, or exactly linear
    #[arg(long, value_enum)]
    servo: SimulatedServo,
    /// Seed of the noise; equal seeds give equal recordings
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// The recording to write
    #[arg(long, short, value_name = "FILE.csv", value_hint = ValueHint::FilePath)]
    out: PathBuf,
    #[command(flatten)]
    output: Output,
    #[command(flatten)]
    reference: ReferenceArgs,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum SimulatedServo {
    Bench,
    Aircraft,
    Linear,
}

impl Simulate {
    pub(super) fn run(self) -> Result<String> {
        let servo = match self.servo {
            SimulatedServo::Bench => "bench",
            SimulatedServo::Aircraft => "aircraft",
            SimulatedServo::Linear => "linear",
        };
        let (rig, talk) = (RigFile::default(), self.output.talk);
        let job = CaptureJob {
            address: &format!("sim:{servo}?seed={}", self.seed),
            reference: self.reference.resolve(rig.servo.us_per_degree, talk)?,
            rig,
            condition: servo,
            notes: "",
            release: false,
            files: std::slice::from_ref(&self.out),
            force: self.output.force,
        };
        let ends = capture(&job, &Monitor::plain(talk), talk)?;
        let rows: u64 = ends.iter().map(|end| end.rows).sum();
        let text = format!("{}: {rows} samples\n", self.out.display());
        talk.result(text, &serde_json::json!({ "file": self.out, "rows": rows }))
    }
}
