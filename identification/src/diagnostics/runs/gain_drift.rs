//! Whether the gain of the servo changes along a run, as under a supply that sags.
//!
//! In each [block](crate::diagnostics::runs::run_blocks) of a run, the errors e of the model and its output s give the part by which the servo goes farther than the model,
//!
//! ```text
//! g = Σ (e - ē)(s - s̄) / Σ (s - s̄)²
//! ```
//!
//! It may change evenly, or at once: the course is a straight line, or a step between two blocks. Of these, the smallest probability counts, as often as
//! there are courses (Bonferroni).

use super::run_blocks::{Block, BlockCourse, Blocks};
use crate::data::{Moments, Record};
use crate::estimation::GlsFit;
use crate::thresholds::{GAIN_DRIFT_PERCENT, LAG_DRIFT_SIGNIFICANCE};

/// A gain that changes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct GainDrift {
    /// Change from the beginning to the end of the longest run, as a part of the gain at the beginning; positive where the servo goes farther.
    pub(crate) change: f64,
    /// The time at which it changes at once \[s\]; `None` where it changes evenly.
    pub(crate) at_s: Option<f64>,
    /// Probability of as much, if the gain does not change.
    pub(crate) p: f64,
}

/// The change of the gain along the runs, where it is beyond chance and matters.
pub(crate) fn gain_drift(record: &Record, moments: &Moments, fit: &GlsFit) -> Option<GainDrift> {
    let blocks = Blocks::of(record, moments, fit, |run| run.output.clone())?;
    let places = blocks.places();
    // A single block at an end is no course.
    let between = places.windows(2).map(|pair| 0.5 * (pair[0] + pair[1]));
    let inner = between.skip(1).take(places.len().saturating_sub(3));
    let even = blocks
        .course(&|block| block.at)
        .map(|course| (of_beginning(course, blocks.longest as f64), None, course.p));
    let steps = inner.filter_map(|place| {
        let after = |block: &Block| f64::from(u8::from(block.at > place));
        let course = blocks.course(&after)?;
        let at_s = place * record.sample_period_s();
        Some((of_beginning(course, 1.0), Some(at_s), course.p))
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

/// The change over a `time`, as a part of the gain at its beginning: the values are parts of the gain of the model, which is the mean.
fn of_beginning(course: BlockCourse, time: f64) -> f64 {
    course.slope * time / (1.0 - course.slope * course.mean_time)
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    /// From 1.00 to 0.88, which is 0.1277 of the mean, along 600 samples or at a third of them.
    #[test]
    fn a_change_is_a_part_of_the_gain_at_the_beginning() {
        let course = |slope: f64, mean_time: f64| BlockCourse {
            slope,
            mean_time,
            p: 0.0,
        };
        let evenly = course(-0.12 / 0.94 / 600.0, 300.0);
        assert_relative_eq!(of_beginning(evenly, 600.0), -0.12, max_relative = 1e-9);
        let at_once = course(-0.12 / 0.92, 2.0 / 3.0);
        assert_relative_eq!(of_beginning(at_once, 1.0), -0.12, max_relative = 1e-9);
    }
}
