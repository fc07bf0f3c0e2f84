//! What the numbers of the kernels minimise.

use super::evidence::{Free, Marginal, kernels_of};
use super::kernel::Kernel;
use super::slow_kernel::SlowEnd;

/// Longest time constant of a kernel, in N.
const TIMES_LONGEST: f64 = 10.0;
/// Longest length of a kernel \[samples\], and the shortest as its inverse: beyond, neighbours are one, or strangers.
const LENGTHS: f64 = 1e6;

/// -2 ln of the marginal likelihood, and of what is known of a slow end where there is a second kernel.
pub(super) struct Objective<'a> {
    pub(super) free: Free<'a>,
    pub(super) slow_end: Option<SlowEnd>,
}

impl Objective<'_> {
    /// The marginal, the value and its gradient; `None` where they cannot be computed.
    pub(super) fn at(&self, numbers: &[f64]) -> Option<(Marginal, f64, Vec<f64>)> {
        let kernels = kernels_of(numbers);
        let marginal = Marginal::of(&self.free, &kernels)?;
        let mut gradient = marginal.gradient(&kernels);
        let mut value = marginal.value();
        if let (Some(expected), [fast, slow]) = (&self.slow_end, &kernels[..]) {
            let (penalty, slopes) = expected.penalty(fast, slow);
            value += penalty;
            gradient
                .iter_mut()
                .zip(slopes)
                .for_each(|(sum, slope)| *sum += slope);
        }
        value.is_finite().then_some((marginal, value, gradient))
    }

    /// [`Objective::at`] without the marginal, where the kernels are those of a response: that of one sample alone, or of one
    /// that never ends, can have any size.
    pub(super) fn value(&self, numbers: &[f64]) -> Option<(f64, Vec<f64>)> {
        let longest = (TIMES_LONGEST * self.free.response.len() as f64).ln();
        let is_response = |kernel: &Kernel| {
            (0.0..longest).contains(&kernel.log_decay) && kernel.log_length.abs() < LENGTHS.ln()
        };
        if !kernels_of(numbers).iter().all(is_response) {
            return None;
        }
        self.at(numbers)
            .map(|(_, value, gradient)| (value, gradient))
    }

    /// The value for a single kernel.
    pub(super) fn of_one(&self, kernel: &Kernel) -> f64 {
        let found = Marginal::of(&self.free, &[*kernel]);
        found.map_or(f64::INFINITY, |found| found.value())
    }
}
