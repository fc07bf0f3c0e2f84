//! `servoid`: the command line.

use std::process::ExitCode;

fn main() -> ExitCode {
    servoid::commands::run(std::env::args_os()).into()
}
