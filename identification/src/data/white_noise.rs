//! The white noise of an output, beside its motion.

use crate::data::{Record, Run};
use crate::numerics::median;

/// Standard deviation of white noise with the fourth differences of the outputs, which motion hardly has.
pub(crate) fn white_noise(record: &Record) -> Option<f64> {
    /// The median size of a normal variable, and the root of 1 + 16 + 36 + 16 + 1.
    const OF_MEDIAN: f64 = 0.674_490;
    const OF_DIFFERENCE: f64 = 8.366_600;
    let of_run = |run: &Run<'_>| -> Vec<f64> {
        let fives = run.output().windows(5);
        let sizes = fives.map(|y| (y[0] - 4.0 * y[1] + 6.0 * y[2] - 4.0 * y[3] + y[4]).abs());
        sizes.filter(|size| !size.is_nan()).collect()
    };
    let sizes = record.runs().iter().flat_map(of_run).collect();
    median(sizes).map(|size| size / (OF_MEDIAN * OF_DIFFERENCE))
}
