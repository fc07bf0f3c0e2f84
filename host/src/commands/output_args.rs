//! The options `--json` and `--quiet` of every command, and where its words go.
//!
//! Results go to standard output, everything else to standard error.

use super::output_files;
use anyhow::Result;
use clap::Args;
use std::io::Write;

/// Prints a line on standard error. A closed pipe or a terminal that is gone must not end a run on a servo, so
/// an error is ignored.
pub fn print_remark(line: impl std::fmt::Display) {
    let _nobody_listens = writeln!(std::io::stderr(), "{line}");
}

/// The form of a command's output.
#[derive(Clone, Copy, Debug, Args)]
pub(super) struct Talk {
    /// Print the result as one JSON object
    #[arg(long)]
    pub json: bool,
    /// Print the result and errors only
    #[arg(long, short)]
    pub quiet: bool,
}

impl Talk {
    /// A remark for the person at the terminal.
    pub(super) fn say(self, remark: impl std::fmt::Display) {
        if !self.quiet {
            print_remark(remark);
        }
    }

    /// The result, as text or as JSON.
    pub(super) fn result(self, text: String, value: &impl serde::Serialize) -> Result<String> {
        if self.json {
            output_files::to_json(value)
        } else {
            Ok(text)
        }
    }
}
