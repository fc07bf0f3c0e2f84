//! Programs of others that tests need.

use std::io::Write;

/// A tool that a test needs is not on this machine: the test has not tested. That is a failure where `CI` is
/// set, so that no test is green for ever because nobody installed its tool.
pub fn missing(test: &str, reason: &str) {
    assert!(std::env::var_os("CI").is_none(), "{test}: {reason}");
    skipped(test, reason);
}

/// Says on the terminal why a test has not tested: past the capture that hides what passing tests print.
pub fn skipped(test: &str, reason: &str) {
    let _infallible = writeln!(std::io::stderr(), "SKIPPED {test}: {reason}");
}
