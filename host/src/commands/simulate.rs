//! `servoid simulate`

use super::Talk;
use super::capture::{Job, capture};
use super::watch::Watch;
use crate::rig::RigFile;
use anyhow::Result;
use clap::{Args, ValueEnum};
use servoid_protocol::reference::{Reference, Staircase};
use std::path::PathBuf;

/// Record a simulated servo on the paper's staircase, as fast as the machine allows
///
/// The same as 'servoid capture' with --port sim:SERVO?seed=S, which takes other references too.
#[derive(Debug, Args)]
#[command(after_help = "Example:
  servoid simulate --servo aircraft --seed 3 -o aircraft.csv")]
pub(super) struct Simulate {
    /// Which servo: free on the bench, loaded by a rotor, or exactly linear
    #[arg(long, value_enum)]
    servo: Servo,
    /// Seed of the noise: the same one gives the same recording
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// The recording to write
    #[arg(long, short, value_name = "FILE.csv")]
    out: PathBuf,
    /// Replace the file if it exists
    #[arg(long)]
    force: bool,
    #[command(flatten)]
    talk: Talk,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Servo {
    Bench,
    Aircraft,
    Linear,
}

impl Simulate {
    pub(super) fn run(self) -> Result<String> {
        let servo = match self.servo {
            Servo::Bench => "bench",
            Servo::Aircraft => "aircraft",
            Servo::Linear => "linear",
        };
        let ends = capture(
            &Job {
                address: &format!("sim:{servo}?seed={}", self.seed),
                rig: RigFile::default(),
                reference: Reference::Staircase(Staircase::PAPER),
                condition: servo,
                notes: "",
                release: false,
                files: std::slice::from_ref(&self.out),
                force: self.force,
            },
            &Watch::plainly(self.talk),
            self.talk,
        )?;
        let rows: u64 = ends.iter().map(|end| end.rows).sum();
        let text = format!("{}: {rows} samples\n", self.out.display());
        self.talk
            .result(text, &serde_json::json!({ "file": self.out, "rows": rows }))
    }
}
