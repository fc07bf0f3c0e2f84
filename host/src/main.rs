//! `servoid`: the command line.

use clap::Parser;
use servoid::commands::{Cli, PartialRecording, file_size_limit};
use std::process::ExitCode;

fn main() -> ExitCode {
    if let Err(error) = file_size_limit::beyond_it_is_an_error() {
        return fail(&error, ExitCode::FAILURE);
    }
    let cli = Cli::parse();
    match cli.run() {
        Ok(result) => print(&result, ExitCode::SUCCESS),
        Err(error) => match error.downcast_ref::<PartialRecording>() {
            Some(partial) => match partial.result() {
                Some(result) => print(result, PartialRecording::EXIT_CODE.into()),
                None => fail(&error, PartialRecording::EXIT_CODE.into()),
            },
            None => fail(&error, ExitCode::FAILURE),
        },
    }
}

fn print(result: &str, code: ExitCode) -> ExitCode {
    match servoid::commands::print_result(result) {
        Ok(()) => code,
        // The reader of a pipe may stop early ('| head'): its business, not an error.
        Err(error) if error.kind() == std::io::ErrorKind::BrokenPipe => code,
        Err(error) => fail(&error.into(), ExitCode::FAILURE),
    }
}

fn fail(error: &anyhow::Error, code: ExitCode) -> ExitCode {
    // Causes on one line, behind the sentence that they explain.
    servoid::commands::print_remark(format_args!("servoid: {error:#}"));
    code
}
