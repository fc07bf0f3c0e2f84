//! Whether the servo answers later and later, or sooner and sooner, along a run: two clocks that differ, or a servo that changes.
//!
//! In each block of a run, the errors e of the model and the speed s' of its output give the time by which the servo is later than the
//! model,
//!
//! ```text
//! τ = -Σ (e - ē) s' / Σ (s' - s̄')²
//! ```
//!
//! Its slope over the run is that of the [blocks](crate::diagnostics::runs::run_blocks).

use super::run_blocks::{BlockCourse, Blocks};
use crate::data::{Moments, Record};
use crate::estimation::GlsFit;
use crate::thresholds::{LAG_DRIFT_SAMPLES, LAG_DRIFT_SIGNIFICANCE};

/// A lag that changes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct LagDrift {
    /// Change of the lag for each second \[s/s\]; positive where the servo gets later.
    pub(crate) rate: f64,
    /// Change from the beginning to the end of the longest run \[s\].
    pub(crate) change_s: f64,
    /// Probability of as much, if the lag does not change.
    pub(crate) p: f64,
}

/// The change of the lag along the runs, where it is beyond chance and matters.
pub(crate) fn lag_drift(record: &Record, moments: &Moments, fit: &GlsFit) -> Option<LagDrift> {
    let blocks = Blocks::of(record, moments, fit, |run| run.speed())?;
    let BlockCourse { slope, p, .. } = blocks.course(&|block| block.at)?;
    // Errors that go with the speed are those of a servo that is ahead.
    let slope = -slope;
    let change = slope * blocks.longest as f64;
    (p < LAG_DRIFT_SIGNIFICANCE && change.abs() > LAG_DRIFT_SAMPLES).then(|| LagDrift {
        rate: slope,
        change_s: change * record.sample_period_s(),
        p,
    })
}
