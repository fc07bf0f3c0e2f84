//! `servoid`: the command line.

use clap::Parser;
use servoid::commands::Cli;
use std::io::Write;
use std::process::ExitCode;

fn main() -> ExitCode {
    let cli = Cli::parse();
    match cli.run() {
        Ok(result) => match std::io::stdout().write_all(result.as_bytes()) {
            Ok(()) => ExitCode::SUCCESS,
            // The reader of a pipe may stop early ('| head'): its business, not an error.
            Err(error) if error.kind() == std::io::ErrorKind::BrokenPipe => ExitCode::SUCCESS,
            Err(error) => fail(&error.into()),
        },
        Err(error) => fail(&error),
    }
}

fn fail(error: &anyhow::Error) -> ExitCode {
    // Causes on one line, behind the sentence that they explain.
    servoid::commands::print_remark(format_args!("servoid: {error:#}"));
    ExitCode::FAILURE
}
