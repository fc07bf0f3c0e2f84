//! The command line: each command a thin file over the library.
//!
//! Results go to standard output, everything else to standard error.

mod ask;
mod calibrate;
mod capture;
mod compare;
mod completions;
mod demo;
mod export;
mod identify;
mod info;
mod init;
mod interrupt;
mod man;
pub mod output_files;
mod plan;
mod ports;
mod progress;
mod recover;
mod reference_args;
mod report;
mod rig_args;
pub mod rig_wizard;
mod simulate;
mod suggest;
mod table_args;
mod validate;
mod watch;

use crate::data::dataset::listed;
use anyhow::Result;
use clap::error::ErrorKind;
use clap::{Args, CommandFactory, Parser, Subcommand};
use std::path::Path;

/// Measures how an R/C servo really moves, and says how sure it is.
#[derive(Debug, Parser)]
#[command(
    version,
    max_term_width = 100,
    propagate_version = true,
    after_help = "Examples:
  servoid demo                                                  without any hardware
  servoid init                                                  with a board: writes rig.toml
  servoid capture --port /dev/ttyUSB0 -o bench.csv
  servoid identify bench.csv -o bench.json --plots plots
  servoid identify mine.csv --input u --output y --period 0.02  with a recording of your own"
)]
pub struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    Demo(demo::Demo),
    Ports(ports::Ports),
    Info(info::Info),
    Init(init::Init),
    Calibrate(calibrate::Calibrate),
    Plan(plan::PlanArgs),
    Capture(capture::CaptureArgs),
    Identify(identify::Identify),
    Validate(validate::Validate),
    Compare(compare::Compare),
    Report(report::Report),
    Export(export::ExportArgs),
    Simulate(simulate::Simulate),
    Recover(recover::Recover),
    Completions(completions::Completions),
    Man(man::ManArgs),
}

impl Cli {
    /// Does what was asked for; returns what goes to standard output.
    ///
    /// # Errors
    /// One sentence that says what to do.
    pub fn run(self) -> Result<String> {
        match self.command {
            Command::Demo(command) => command.run(),
            Command::Ports(command) => command.run(),
            Command::Info(command) => command.run(),
            Command::Init(command) => command.run(),
            Command::Calibrate(command) => command.run(),
            Command::Plan(command) => command.run(),
            Command::Capture(command) => command.run(),
            Command::Identify(command) => command.run(),
            Command::Validate(command) => command.run(),
            Command::Compare(command) => command.run(),
            Command::Report(command) => command.run(),
            Command::Export(command) => command.run(),
            Command::Simulate(command) => command.run(),
            Command::Recover(command) => command.run(),
            Command::Completions(command) => command.run(),
            Command::Man(command) => command.run(),
        }
    }
}

/// How much is said, and in which form.
#[derive(Clone, Copy, Debug, Args)]
struct Talk {
    /// Print the result as one JSON object
    #[arg(long)]
    json: bool,
    /// Say nothing but the result and errors
    #[arg(long, short)]
    quiet: bool,
}

impl Talk {
    /// A remark for the person at the terminal.
    fn say(self, remark: impl std::fmt::Display) {
        if !self.quiet {
            crate::commands::output_files::tell(remark);
        }
    }

    /// The result in the form that was asked for.
    fn result(self, text: String, value: &impl serde::Serialize) -> Result<String> {
        if self.json {
            crate::commands::output_files::to_json(value)
        } else {
            Ok(text)
        }
    }
}

/// Wrong usage that only shows once options are taken together: says so, and ends with exit code 2.
fn wrong_usage(error: impl std::fmt::Display) -> ! {
    Cli::command()
        .error(ErrorKind::ValueValidation, error)
        .exit()
}

/// A margin that a difference is held against (percent).
fn margin(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(percent) if percent >= 0.0 && percent.is_finite() => Ok(percent),
        _ => Err("a number of percent, 0 or above, is needed".to_owned()),
    }
}

/// A confidence level: a fraction below one, or percent above it.
fn level(text: &str) -> Result<f64, String> {
    let number = text.trim().trim_end_matches('%').trim_end();
    let percent = number.len() < text.trim().len();
    match number.parse::<f64>() {
        Ok(level) if !percent && level > 0.0 && level < 1.0 => Ok(level),
        Ok(level) if level > 1.0 && level < 100.0 => Ok(level / 100.0),
        _ => Err(
            "a fraction such as 0.99, or percent such as 99, is needed; from 50 to 99.999 percent"
                .to_owned(),
        ),
    }
}

/// What a file is called in plots and on the terminal: its name without folder and ending.
fn stem(path: &Path) -> String {
    path.file_stem()
        .unwrap_or(path.as_os_str())
        .to_string_lossy()
        .into_owned()
}

/// Whether a file is a model by its name; anything else is read as a recording.
fn is_model(path: &Path) -> bool {
    path.extension().is_some_and(|ending| ending == "json")
}
