//! Whether the gain of the servo changes along a run, as under a supply that sags.
//!
//! In each [block](super::run_blocks) of a run, the errors e of the model and its output s give the part by which the servo goes farther than the model,
//!
//! ```text
//! g = Σ (e - ē)(s - s̄) / Σ (s - s̄)²
//! ```
//!
//! It may change evenly, or at once: the course is a straight line, or a step between two blocks. Of these, the smallest probability counts, as often as
//! there are courses (Bonferroni).

use crate::data::{Moments, Record};
use crate::diagnostics::run_blocks::{Block, command_is_even, course, in_blocks};
use crate::diagnostics::simulation_error::simulated_whole;
use crate::estimation::GlsFit;
use crate::thresholds::{GAIN_DRIFT_PERCENT, LAG_DRIFT_SIGNIFICANCE};

/// A gain that changes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct GainDrift {
    /// Change from the beginning to the end of the longest run, as a part of the gain; positive where the servo goes farther.
    pub(crate) change: f64,
    /// The time at which it changes at once \[s\]; `None` where it changes evenly.
    pub(crate) at_s: Option<f64>,
    /// Probability of as much, if the gain does not change.
    pub(crate) p: f64,
}

/// The change of the gain along the runs, where it is beyond chance and matters.
pub(crate) fn gain_drift(record: &Record, moments: &Moments, fit: &GlsFit) -> Option<GainDrift> {
    if !command_is_even(record) {
        return None;
    }
    let runs = simulated_whole(record, moments, fit);
    let longest = runs.iter().map(|run| run.errors.len()).max()?;
    let blocks = in_blocks(&runs, fit.coordinates.basis.settling(), |run| {
        run.output.clone()
    });
    let mut places: Vec<f64> = blocks.iter().map(|block| block.at).collect();
    places.sort_by(f64::total_cmp);
    places.dedup();
    // A single block at an end is no course.
    let between = places.windows(2).map(|pair| 0.5 * (pair[0] + pair[1]));
    let inner = between.skip(1).take(places.len().saturating_sub(3));
    let even = course(&blocks, runs.len(), &|block| block.at)
        .map(|(slope, p)| (slope * longest as f64, None, p));
    let steps = inner.filter_map(|place| {
        let after = |block: &Block| f64::from(u8::from(block.at > place));
        let (change, p) = course(&blocks, runs.len(), &after)?;
        Some((change, Some(place * record.sample_period_s()), p))
    });
    let courses: Vec<_> = even.into_iter().chain(steps).collect();
    let (change, at_s, p) = *courses.iter().min_by(|a, b| a.2.total_cmp(&b.2))?;
    let p = (p * courses.len() as f64).min(1.0);
    (p < LAG_DRIFT_SIGNIFICANCE && 100.0 * change.abs() > GAIN_DRIFT_PERCENT).then_some(GainDrift {
        change,
        at_s,
        p,
    })
}
