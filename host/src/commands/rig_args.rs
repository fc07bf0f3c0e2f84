//! The options that say which rig is meant, and under what condition it stands.

use super::suggest;
use crate::data::rig_file::RigFile;
use crate::instrument::port;
use anyhow::{Result, bail};
use clap::{Args, ValueHint};
use std::path::PathBuf;

/// Where a rig is, what is known of it, and whether it may move.
#[derive(Clone, Debug, Args)]
pub(super) struct RigArgs {
    /// Where the rig is: a serial device, tcp:HOST:PORT, or sim:bench, sim:aircraft, sim:linear
    /// (sim:bench?realtime&seed=7 for real pace and another noise)
    #[arg(long, short, value_parser = suggest::port(), hide_possible_values = true)]
    pub port: Option<String>,
    /// What is known of servo and sensor, as 'servoid init' writes it; without it: 1500 µs neutral, 10 µs
    /// per degree, a Honeywell RTY sensor of 120 degrees
    #[arg(long, value_name = "RIG.toml", value_hint = ValueHint::FilePath)]
    pub rig: Option<PathBuf>,
    /// Under what condition: bench, aircraft, or words of your own; without it, that of the rig file, or
    /// the name of the simulated servo, or bench
    #[arg(long, value_parser = suggest::condition(), hide_possible_values = true)]
    condition: Option<String>,
    /// I have read the safety rules, and nobody is near the rotor (needed for every condition but
    /// bench)
    #[arg(long)]
    arm: bool,
}

/// A rig that may be moved.
pub(super) struct Rig {
    pub address: String,
    pub file: RigFile,
    pub condition: String,
}

/// The one condition under which nobody is near a rotor.
const BENCH: &str = "bench";

impl RigArgs {
    /// What is known of the rig.
    pub(super) fn file(&self) -> Result<RigFile> {
        Ok(match &self.rig {
            Some(path) => RigFile::read(path)?,
            None => RigFile::default(),
        })
    }

    /// The rig, if it is known where it is and if it may move.
    pub(super) fn require(&self) -> Result<Rig> {
        let file = self.file()?;
        let Some(address) = self.port.clone().or_else(|| file.port.clone()) else {
            bail!(
                "say where the rig is, with --port or with 'port' in the rig file: 'servoid ports' lists the serial ports, and sim:bench needs none"
            );
        };
        let simulated = port::simulated_servo(&address);
        let condition = self.condition.clone().or_else(|| file.condition.clone());
        let condition = condition.unwrap_or_else(|| simulated.unwrap_or(BENCH).to_owned());
        // Any condition that is not just the bench may be a loaded servo.
        if condition != BENCH && simulated.is_none() && !self.arm {
            bail!(
                "the condition {condition:?} may move a loaded servo, only {BENCH:?} by itself may not: read the safety rules in the README, clear the rotor, then add --arm"
            );
        }
        Ok(Rig {
            address,
            file,
            condition,
        })
    }
}
