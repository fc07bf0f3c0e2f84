//! The command line: each command a thin file over the library.

mod calibrate;
mod capture;
mod compare;
mod completion_values;
mod completions;
mod ctrl_c;
mod demo;
mod export;
mod file_size_limit;
mod flash;
mod identify;
mod info;
mod init;
mod input;
mod man;
mod output;
mod partial_recording;
mod plan;
mod ports;
mod prompts;
mod recover;
mod reference_args;
mod report;
mod rig_args;
mod rig_remarks;
mod rig_wizard;
mod selftest;
mod servo_search;
mod simulate;
mod validate;
mod value_parsers;

pub use output::{print_remark, print_result};
pub use partial_recording::PartialRecording;
use selftest::FailedSelfTest;

use anyhow::Result;
use clap::{CommandFactory, Parser, Subcommand};
use std::ffi::OsString;

/// Measures the motion of R/C servos: step and frequency response, with 99 % bounds
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
  servoid identify mine.csv --input u --output y --period 0.02  with your own recording"
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
    Flash(flash::Flash),
    #[command(name = "selftest")]
    SelfTest(selftest::SelfTest),
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
    /// Runs the command; returns the text for standard output.
    ///
    /// # Errors
    /// One sentence: the failure, its reason, and what to do.
    pub fn run(self) -> Result<String> {
        match self.command {
            Command::Demo(command) => command.run(),
            Command::Ports(command) => command.run(),
            Command::Info(command) => command.run(),
            Command::Flash(command) => command.run(),
            Command::SelfTest(command) => command.run(),
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
            Command::Completions(command) => command.run(Self::command()),
            Command::Man(command) => command.run(Self::command()),
        }
    }
}

/// Runs the command of these arguments, the name of the program first; returns the exit code. Wrong usage, and requests for
/// help, end the process.
pub fn run(arguments: impl IntoIterator<Item = OsString>) -> u8 {
    let ready = file_size_limit::beyond_it_is_an_error();
    match ready.and_then(|()| Cli::parse_from(arguments).run()) {
        Ok(result) => print(&result, SUCCESS),
        Err(error) => match error.downcast_ref::<PartialRecording>() {
            Some(partial) => match partial.result() {
                Some(result) => print(result, PartialRecording::EXIT_CODE),
                None => fail(&error, PartialRecording::EXIT_CODE),
            },
            None => {
                if let Some(failed) = error.downcast_ref::<FailedSelfTest>() {
                    print(failed.result(), FAILURE);
                }
                fail(&error, FAILURE)
            }
        },
    }
}

const SUCCESS: u8 = 0;
const FAILURE: u8 = 1;

fn print(result: &str, code: u8) -> u8 {
    match print_result(result) {
        Ok(()) => code,
        // The reader of a pipe may stop early ('| head'): its business, not an error.
        Err(error) if error.kind() == std::io::ErrorKind::BrokenPipe => code,
        Err(error) => fail(&error.into(), FAILURE),
    }
}

fn fail(error: &anyhow::Error, code: u8) -> u8 {
    // Causes on one line, behind the sentence that they explain.
    let option = error
        .chain()
        .find_map(option)
        .map(|option| format!(" ({option})"));
    print_remark(format_args!(
        "servoid: {error:#}{}",
        option.unwrap_or_default()
    ));
    code
}

/// The option that an error of the library asks for; the library, which Python shares, knows none.
fn option(cause: &(dyn std::error::Error + 'static)) -> Option<String> {
    use servoid_identification::Error;
    let option = match cause.downcast_ref()? {
        Error::TooShortForAuto {
            samples,
            needed,
            at_rest,
        } => {
            let settling = match (samples < needed, Error::settling_for(*samples)) {
                (true, Some(settling)) => Some(format!("--settling {settling}")),
                (true, None) => None,
                (false, _) => Some("--settling N".to_owned()),
            };
            let rest = at_rest.map(|input| format!("--at-rest {input}"));
            let options: Vec<String> = rest.into_iter().chain(settling).collect();
            return (!options.is_empty()).then(|| options.join(", or "));
        }
        Error::OutputsFarApart { .. } => "--settling N --at-rest INPUT --noise-order 0",
        Error::StepsBeforeRuns | Error::StepsInHistory { .. } => "--at-rest INPUT",
        Error::CountsSamples => "--output COLUMN",
        Error::Swapped { .. } => "--input names the command, --output the motion",
        _ => return None,
    };
    Some(option.to_owned())
}
