//! How well kernels explain an estimate: the marginal likelihood.

use faer::Mat;

use super::kernel::{Kernel, NUMBERS};
use crate::numerics::{backward_solve, cholesky, dot, forward_solve, inverse_of_square, times};

/// An estimate of the impulse response without a prior, in standard deviations of ε.
pub(super) struct Free<'a> {
    /// h.
    pub(super) response: &'a [f64],
    /// V: its covariance.
    pub(super) covariance: &'a Mat<f64>,
}

/// The estimate under a prior: h ~ N(0, S), S = K + V.
pub(super) struct Marginal {
    /// K of each kernel.
    pub(super) kernels: Vec<Mat<f64>>,
    /// Lower Cholesky factor of S.
    pub(super) factor: Mat<f64>,
    /// L^-1 h.
    pub(super) whitened: Vec<f64>,
}

impl Marginal {
    /// `None` where the kernels cannot be computed with.
    pub(super) fn of(free: &Free<'_>, kernels: &[Kernel]) -> Option<Self> {
        let samples = free.response.len();
        let kernels: Vec<_> = kernels
            .iter()
            .map(|kernel| kernel.covariance(samples))
            .collect();
        let mut sum = free.covariance.clone();
        for kernel in &kernels {
            sum += kernel;
        }
        let factor = cholesky(&sum)?;
        let whitened = forward_solve(&factor, free.response);
        Some(Self {
            kernels,
            factor,
            whitened,
        })
    }

    /// E h = K (K + V)^-1 h.
    pub(super) fn mean(&self) -> Vec<f64> {
        let alpha = backward_solve(&self.factor, &self.whitened);
        let mut mean = vec![0.0; alpha.len()];
        for kernel in &self.kernels {
            let part = times(kernel, &alpha);
            mean.iter_mut().zip(part).for_each(|(sum, h)| *sum += h);
        }
        mean
    }

    /// -2 ln of the marginal likelihood, but for a constant.
    pub(super) fn value(&self) -> f64 {
        let diagonal = (0..self.whitened.len()).map(|i| self.factor[(i, i)].ln());
        2.0 * diagonal.sum::<f64>() + dot(&self.whitened, &self.whitened)
    }

    /// Its derivatives by the numbers of all kernels: tr((S^-1 - αα') dK), α = S^-1 h.
    pub(super) fn gradient(&self, kernels: &[Kernel]) -> Vec<f64> {
        let mut weights = inverse_of_square(&self.factor);
        let alpha = backward_solve(&self.factor, &self.whitened);
        for (j, a) in alpha.iter().enumerate() {
            for (weight, b) in weights.col_as_slice_mut(j).iter_mut().zip(&alpha) {
                *weight -= a * b;
            }
        }
        let slopes = kernels.iter().zip(&self.kernels);
        slopes
            .flat_map(|(kernel, covariance)| kernel.weighted_slopes(covariance, &weights))
            .collect()
    }
}

/// Kernels of their numbers, [`NUMBERS`] for each.
pub(super) fn kernels_of(numbers: &[f64]) -> Vec<Kernel> {
    numbers.chunks(NUMBERS).map(Kernel::of).collect()
}
