//! A run with its errors one step ahead and its holds.

use crate::data::{EXACTLY, Hold, holds};
use crate::diagnostics::residuals::simulation_error::{Simulated, one_step_errors};
use crate::estimation::GlsFit;

/// What is asked from hold to hold of a run.
pub(super) struct HeldRun<'a> {
    pub(super) run: &'a Simulated<'a>,
    /// ε(k), but for what runs differ by; NaN where it is missing.
    pub(super) errors: Vec<f64>,
    /// The holds of its command.
    pub(super) holds: Vec<Hold>,
}

impl<'a> HeldRun<'a> {
    /// Those of `runs`, which `fit` has simulated.
    pub(super) fn all(runs: &'a [Simulated<'a>], fit: &GlsFit) -> Vec<Self> {
        let of_run = |run: &'a Simulated<'a>| Self {
            run,
            errors: one_step_errors(run.own_errors(), &fit.ar),
            holds: holds(&run.run, EXACTLY),
        };
        runs.iter().map(of_run).collect()
    }
}
