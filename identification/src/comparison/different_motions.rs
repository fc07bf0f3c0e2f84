//! Whether the references of two sides may be what makes their responses differ.

use super::motion::{Motion, larger_by};
use super::outcome::{Comparison, Sides};
use super::verdict::Verdict;
use crate::results::Bounds;
use crate::thresholds::EQUALLY_LARGE;

/// Whether there is no verdict because the servos were asked for different motions.
///
/// A servo that is not linear has another response for each motion, and a servo that looks linear under each of two references alone need not
/// be: one that is limited in speed is slower over a larger stroke by one and the same factor in all of it. "Different" is therefore said
/// under one reference only. "The same" may be said of sides that both look linear.
pub(super) fn may_explain(found: &Comparison, motions: &Sides<Motion>, linear: bool) -> bool {
    let different = found.verdict == Verdict::Different;
    match motions.a.is_like(&motions.b) {
        false => different || !linear,
        true if motions.a.is_another_draw(&motions.b) && !linear => true,
        true => different && strokes_may_explain(found, motions.a.larger_by(&motions.b)),
    }
}

/// The same of two models, each of a recording with strokes of one size.
pub(super) fn strokes_of_models_may_explain(found: &Comparison, sizes: [f64; 2]) -> bool {
    let larger_by = larger_by(sizes);
    let different = found.verdict == Verdict::Different;
    different && (larger_by > EQUALLY_LARGE || strokes_may_explain(found, larger_by))
}

/// Whether what exceeds the margin may come from strokes that are nearly equal, such as those of a whole number of microseconds by two calibrations.
///
/// Over a stroke that is larger by the fraction e a servo goes no less far, and at most farther by e. As shares of the stroke, which a step
/// response is, the two then differ by e at most.
fn strokes_may_explain(found: &Comparison, larger_by: f64) -> bool {
    let Bounds::Valid(bounds) = found.bounds else {
        return false;
    };
    bounds.difference_percent.at_least <= found.margin_percent + 100.0 * larger_by
}
