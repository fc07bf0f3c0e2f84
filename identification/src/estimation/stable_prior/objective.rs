//! What the numbers of the kernels minimise.

use super::evidence::{Free, Marginal, kernels_of};
use super::kernel::Kernel;
use super::slow_end::SlowEnd;

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

    /// [`Objective::at`] without the marginal.
    pub(super) fn value(&self, numbers: &[f64]) -> Option<(f64, Vec<f64>)> {
        self.at(numbers)
            .map(|(_, value, gradient)| (value, gradient))
    }

    /// The value for a single kernel.
    pub(super) fn of_one(&self, kernel: &Kernel) -> f64 {
        let found = Marginal::of(&self.free, &[*kernel]);
        found.map_or(f64::INFINITY, |found| found.value())
    }
}
