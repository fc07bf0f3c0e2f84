//! `servoid selftest`

use super::completion_values;
use super::ctrl_c;
use super::output::Output;
use super::prompts::{confirm, is_terminal};
use super::rig_args::RigFileArgs;
use crate::instrument::flash::embedded_image;
use crate::instrument::port;
use crate::instrument::rig::{RigClient, mismatches};
use crate::instrument::selftest::{SelfTestExtent, SelfTestReport, measure};
use anyhow::{Result, bail};
use clap::Args;
use std::fmt;
use std::path::PathBuf;

/// Have a board measure its own pulses and its own timing
#[derive(Debug, Args)]
#[command(
    after_help = "Take the servo and the sensor off, and put one wire from PA1 to the sensor's end of the divider, which is 5.1 kΩ \
before PA4. The board makes pulses of 1000 to 2000 µs for some seconds, and only while it sees them at PA4.

The file has all that was measured: attach it to a report, with the print on the chip. Exit code 1 where something is wrong.

Examples:
  servoid selftest                                 the port of rig.toml
  servoid selftest --port /dev/ttyUSB0 --yes"
)]
pub(super) struct SelfTest {
    /// Port of the board: a serial device, or tcp:HOST:PORT; without it, that of the rig file
    #[arg(long, short, value_parser = completion_values::port(), hide_possible_values = true)]
    port: Option<String>,
    #[command(flatten)]
    rig: RigFileArgs,
    /// Confirm that no servo is connected, and that the wire is in place
    #[arg(long)]
    yes: bool,
    /// File with everything that was measured
    #[arg(long, short, value_name = "FILE", default_value = "selftest.json")]
    output: PathBuf,
    #[command(flatten)]
    files: Output,
}

const SURE: &str = "no servo is connected, and one wire goes from PA1 to the divider before PA4?";

impl SelfTest {
    pub(super) fn run(self) -> Result<String> {
        let talk = self.files.talk;
        let address = self.rig.address(self.port.as_deref(), talk)?;
        if port::is_simulated(&address) {
            bail!("{address} is a simulated rig and has no pins: name the port of a board");
        }
        self.files.check([&self.output])?;
        self.require_confirmation()?;
        ctrl_c::listen()?;
        let port = port::open(&address)?;
        let mut client = RigClient::connect_beside(port, &address)?;
        if let Some(mismatch) = mismatches(client.hello()).first() {
            bail!(
                "the board's {} is {}, this servoid's {}: flash the firmware of this version with 'servoid flash', then start again",
                mismatch.field,
                mismatch.rig,
                mismatch.servoid
            );
        }
        let measured = measure(
            &mut client,
            SelfTestExtent::FULL,
            &ctrl_c::asked,
            &mut |what| talk.say(what),
        )?;
        let image = embedded_image().map(|image| image.sha256());
        let report = SelfTestReport::new(measured, &address, image);
        self.files.write_json(Some(&self.output), &report)?;
        talk.say(format_args!(
            "{} has everything that was measured",
            self.output.display()
        ));
        let result = talk.result(report.text(), &report)?;
        match report.passed() {
            true => Ok(result),
            false => Err(FailedSelfTest {
                result,
                findings: report.findings.len(),
            }
            .into()),
        }
    }

    fn require_confirmation(&self) -> Result<()> {
        if self.yes {
            return Ok(());
        }
        if !is_terminal() {
            bail!(
                "nothing was done: take the servo off, put the wire from PA1 to the divider before PA4, and confirm it with --yes"
            );
        }
        match confirm(SURE)? {
            true => Ok(()),
            false => bail!("nothing was done: take the servo off and put the wire in place first"),
        }
    }
}

/// A self-test that found something. Its result goes to standard output all the same.
#[derive(Debug)]
pub(super) struct FailedSelfTest {
    result: String,
    findings: usize,
}

impl FailedSelfTest {
    /// The table.
    pub(super) fn result(&self) -> &str {
        &self.result
    }
}

impl fmt::Display for FailedSelfTest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (count, words) = match self.findings {
            1 => (1, "thing is"),
            count => (count, "things are"),
        };
        write!(
            f,
            "the self-test failed: {count} {words} wrong with the board or its wires"
        )
    }
}

impl std::error::Error for FailedSelfTest {}
