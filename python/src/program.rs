//! The program `servoid`, which comes with the package.

use pyo3::prelude::*;
use std::ffi::OsString;

/// Runs the program with these arguments, its name first; returns its exit code. Wrong usage ends the process.
#[pyfunction]
pub(crate) fn run_program(py: Python<'_>, arguments: Vec<OsString>) -> u8 {
    py.detach(|| servoid::commands::run(arguments))
}
