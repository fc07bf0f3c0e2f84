//! Wrong usage that only shows once options are taken together.

use clap::Command;
use clap::error::ErrorKind;

/// Prints the error as clap prints its own, and ends the program with exit code 2.
pub(super) fn wrong_usage(error: impl std::fmt::Display) -> ! {
    Command::new("servoid")
        .override_usage("servoid <COMMAND>")
        .error(ErrorKind::ValueValidation, error)
        .exit()
}
