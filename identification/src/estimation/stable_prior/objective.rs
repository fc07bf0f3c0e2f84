//! What the numbers of the kernels minimise.

use super::bfgs::Point;
use super::evidence::{Free, Marginal, kernels_of};
use super::kernel::{Kernel, NUMBERS};
use super::slow_kernel::SlowEndPrior;

/// Longest time constant of a kernel, in N.
const TIMES_LONGEST: f64 = 10.0;
/// Longest length of a kernel \[samples\], and the shortest as its inverse: beyond, neighbours are one, or strangers.
const LENGTHS: f64 = 1e6;

/// -2 ln of the marginal likelihood, and of what is known of a slow end where there is a second kernel.
pub(super) struct Objective<'a> {
    pub(super) free: Free<'a>,
    pub(super) slow_end: Option<SlowEndPrior>,
}

/// The objective at some numbers.
pub(super) struct Evaluated {
    pub(super) marginal: Marginal,
    value: f64,
    /// The derivatives of what is known of a slow end.
    slopes: [f64; 2 * NUMBERS],
}

impl Point for Evaluated {
    fn value(&self) -> f64 {
        self.value
    }

    fn gradient(&self) -> Vec<f64> {
        let of_data = self.marginal.gradient().into_iter();
        of_data.zip(self.slopes).map(|(a, b)| a + b).collect()
    }
}

impl Objective<'_> {
    /// `None` where it cannot be computed.
    pub(super) fn at(&self, numbers: &[f64]) -> Option<Evaluated> {
        let kernels = kernels_of(numbers);
        let marginal = Marginal::of(&self.free, &kernels)?;
        let (penalty, slopes) = match (&self.slow_end, &kernels[..]) {
            (Some(expected), [fast, slow]) => expected.penalty(fast, slow),
            _ => (0.0, [0.0; 2 * NUMBERS]),
        };
        let value = marginal.value() + penalty;
        value.is_finite().then_some(Evaluated {
            marginal,
            value,
            slopes,
        })
    }

    /// [`Objective::at`], where the kernels are those of a response: that of one sample alone, or of one that never ends, can
    /// have any size.
    pub(super) fn of_response(&self, numbers: &[f64]) -> Option<Evaluated> {
        let longest = (TIMES_LONGEST * self.free.response.len() as f64).ln();
        let is_response = |kernel: &Kernel| {
            (0.0..longest).contains(&kernel.log_decay) && kernel.log_length.abs() < LENGTHS.ln()
        };
        if !kernels_of(numbers).iter().all(is_response) {
            return None;
        }
        self.at(numbers)
    }

    /// The value for a single kernel.
    pub(super) fn of_one(&self, kernel: &Kernel) -> f64 {
        let found = Marginal::of(&self.free, &[*kernel]);
        found.map_or(f64::INFINITY, |found| found.value())
    }
}
