//! The options that name the rig and the condition of the measurement.

use super::completion_values;
use super::output::Talk;
use super::rig_remarks;
use crate::data::clock_error::internal_clock_error;
use crate::data::rig_file::RigFile;
use crate::instrument::port;
use anyhow::{Context, Result, bail};
use clap::{Args, ValueHint};
use servoid_protocol::Hello;
use servoid_protocol::hello::ClockSource;
use std::path::{Path, PathBuf};

/// The rig, its file, and the permission to move it.
#[derive(Clone, Debug, Args)]
pub(super) struct RigArgs {
    /// Port of the rig: a serial device, tcp:HOST:PORT, or sim:bench, sim:aircraft, sim:linear
    /// (sim:bench?realtime&seed=7 for real time and another noise)
    #[arg(long, short, value_parser = completion_values::port(), hide_possible_values = true)]
    pub port: Option<String>,
    #[command(flatten)]
    file: RigFileArgs,
    /// Condition of the measurement: bench, aircraft, or your own words; without it, that of the rig file, the
    /// name of the simulated servo, or bench
    #[arg(long, value_parser = completion_values::condition(), hide_possible_values = true)]
    condition: Option<String>,
    /// Confirm that you have read the safety rules and that nobody is near the rotor (needed for every
    /// condition but bench)
    #[arg(long)]
    arm: bool,
    /// Use a board whose crystal does not run: all times and all pulses are then off by -2 to +2.5 %
    #[arg(long)]
    inexact_clock: bool,
}

/// The rig file, named or found.
#[derive(Clone, Debug, Args)]
pub(super) struct RigFileArgs {
    /// The rig file, as 'servoid init' writes it [default: rig.toml of this folder; where there is none: 1500 µs
    /// neutral, 10 µs per degree, a Honeywell RTY sensor of 120 degrees]
    #[arg(long, value_name = "RIG.toml", value_hint = ValueHint::FilePath)]
    rig: Option<PathBuf>,
    /// Leave out the rig.toml of this folder
    #[arg(long, conflicts_with = "rig")]
    no_rig: bool,
}

/// The rig file that is found by itself, and that `servoid init` writes.
pub(super) const FOUND: &str = "rig.toml";

impl RigFileArgs {
    /// The port that is given, or else that of the rig file, which is not read otherwise.
    pub(super) fn address(&self, port: Option<&str>, talk: Talk) -> Result<String> {
        match port {
            Some(port) => Ok(port.to_owned()),
            None => port_of(None, &self.read(None, talk)?.file),
        }
    }

    /// The rig file that applies to the rig at `port`, and its path; the defaults where there is none. A file that was not named
    /// is not that of a simulated servo, unless its port is.
    pub(super) fn read(&self, port: Option<&str>, talk: Talk) -> Result<RigSource> {
        if let Some(path) = &self.rig {
            return RigSource::of(path, talk);
        }
        if self.no_rig || !Path::new(FOUND).exists() {
            return Ok(RigSource::default());
        }
        let found = RigSource::of(Path::new(FOUND), talk)?;
        let simulated = |port: &str| port::simulated_servo(port).map(str::to_owned);
        if let Some(port) = port
            && let Some(servo) = simulated(port)
            && found.file.port.as_deref().and_then(simulated) != Some(servo)
        {
            talk.say(format_args!(
                "rig file: none; {FOUND} is not that of {port} (--rig {FOUND} takes it)"
            ));
            return Ok(RigSource::default());
        }
        talk.say(format_args!("rig file: {FOUND} (--no-rig leaves it out)"));
        Ok(found)
    }
}

/// A rig file and its origin.
#[derive(Clone, Debug, Default)]
pub(super) struct RigSource {
    /// `None` for the defaults.
    pub path: Option<PathBuf>,
    pub file: RigFile,
}

impl RigSource {
    /// That of the file at `path`; its user hears what it leaves out.
    fn of(path: &Path, talk: Talk) -> Result<Self> {
        let text = RigFile::text(path)?;
        let file = RigFile::parse(&text, path)?;
        let remark = rig_remarks::sections_left_out(path, &text);
        remark.into_iter().for_each(|remark| talk.say(remark));
        Ok(Self {
            path: Some(path.to_owned()),
            file,
        })
    }
}

/// A rig that may be moved.
pub(super) struct Rig {
    pub address: String,
    pub file: RigFile,
    pub condition: String,
    /// Whether a board may be used that runs on its internal oscillator.
    pub inexact_clock: bool,
}

/// Refuses a board that runs on its internal oscillator, unless that is `allowed`.
pub(super) fn require_clock(allowed: bool, hello: &Hello) -> Result<()> {
    if hello.clock == ClockSource::InternalRc && !allowed {
        bail!(
            "the servo was not moved: the board's crystal does not run, and on its internal oscillator all times and all pulses are off by {}; repair the crystal, or add --inexact-clock if that does not matter",
            internal_clock_error()
        );
    }
    Ok(())
}

/// The port that is given, or else that of the file.
fn port_of(given: Option<&str>, file: &RigFile) -> Result<String> {
    let found = given.map(str::to_owned).or_else(|| file.port.clone());
    found.context(
        "no port is given: add --port, or 'port' in the rig file; 'servoid ports' lists the serial ports, and sim:bench needs no hardware",
    )
}

/// The one condition without a rotor.
const BENCH: &str = "bench";

/// The simulated servo on the aircraft, and the condition of what is measured there.
pub(super) const AIRCRAFT: &str = "aircraft";

impl RigArgs {
    /// The rig file, named or found, for who does not move the servo.
    pub(super) fn unmoved(&self, talk: Talk) -> Result<RigSource> {
        self.file.read(self.port.as_deref(), talk)
    }

    /// The rig file, named or found. Where there is none, its user hears which pulses the servo gets.
    pub(super) fn source(&self, talk: Talk) -> Result<RigSource> {
        let port = self.port.as_deref();
        let source = self.unmoved(talk)?;
        if source.path.is_none() {
            talk.say(rig_remarks::pulses_without_file(port)?);
        }
        if let Some(address) = port.or(source.file.port.as_deref()) {
            let remarks = [
                rig_remarks::scale_of_another_rig(address, &source.file),
                rig_remarks::delay_of_another_rig(address, &source.file),
            ];
            (remarks.into_iter().flatten()).for_each(|remark| talk.say(remark));
        }
        Ok(source)
    }

    /// The simulated servo at `address` under its own condition, or under words of one's own: a name of the other one would be a lie in the
    /// recording.
    fn require_condition_of(&self, servo: &str, condition: &str, address: &str) -> Result<()> {
        let known = [BENCH, AIRCRAFT];
        if !known.contains(&servo) || !known.contains(&condition) || servo == condition {
            return Ok(());
        }
        let whose = match self.condition {
            None => "by the rig file",
            Some(_) => "as stated",
        };
        bail!(
            "the servo was not moved: the condition is {condition:?}, {whose}, and {address} simulates the servo of {servo:?}: --port sim:{condition} simulates the other one, --condition {servo} records this one"
        );
    }

    /// The rig of `file`, if its port is known and it may move.
    pub(super) fn require(&self, file: RigFile) -> Result<Rig> {
        let address = port_of(self.port.as_deref(), &file)?;
        let simulated = port::simulated_servo(&address);
        let condition = self.condition.clone().or_else(|| file.condition.clone());
        let condition = condition.unwrap_or_else(|| simulated.unwrap_or(BENCH).to_owned());
        if let Some(servo) = simulated {
            self.require_condition_of(servo, &condition, &address)?;
        }
        // The servo may be loaded under any other condition.
        if condition != BENCH && simulated.is_none() && !self.arm {
            bail!(
                "the servo was not moved: it may be loaded under the condition {condition:?}; read the safety rules in the README, clear the rotor, then add --arm"
            );
        }
        Ok(Rig {
            address,
            file,
            condition,
            inexact_clock: self.inexact_clock,
        })
    }
}
