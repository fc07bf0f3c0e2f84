//! How well kernels explain an estimate: the marginal likelihood.

use faer::Mat;

use super::kernel::{Entries, Kernel, NUMBERS};
use crate::numerics::{backward_solve, dot, factorised, forward_solve, inverse_of_lower, mirror};

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
    pub(super) kernels: Vec<Entries>,
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
            .map(|kernel| kernel.entries(samples))
            .collect();
        let mut sum = free.covariance.clone();
        for kernel in &kernels {
            kernel.add_below(&mut sum);
        }
        let factor = factorised(sum)?;
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
            kernel.add_times(&alpha, &mut mean);
        }
        mean
    }

    /// -2 ln of the marginal likelihood, but for a constant.
    pub(super) fn value(&self) -> f64 {
        let diagonal = (0..self.whitened.len()).map(|i| self.factor[(i, i)].ln());
        2.0 * diagonal.sum::<f64>() + dot(&self.whitened, &self.whitened)
    }

    /// K of all kernels together.
    pub(super) fn prior(&self) -> Mat<f64> {
        let samples = self.whitened.len();
        let mut prior = Mat::zeros(samples, samples);
        for kernel in &self.kernels {
            kernel.add_below(&mut prior);
        }
        mirror(&mut prior);
        prior
    }

    /// Its derivatives by the numbers of all kernels: tr(L^-1 dK L^-T) - α'dK α, α = S^-1 h.
    pub(super) fn gradient(&self) -> Vec<f64> {
        let whiten = inverse_of_lower(&self.factor);
        let alpha = backward_solve(&self.factor, &self.whitened);
        let slopes = |kernel: &Entries| {
            let of_noise = kernel.slopes(alpha.len(), |j| &whiten.col_as_slice(j)[j..]);
            let of_response = kernel.slopes(1, |j| &alpha[j..=j]);
            [0, 1, 2].map(|k| of_noise[k] - of_response[k])
        };
        self.kernels.iter().flat_map(slopes).collect()
    }
}

/// Kernels of their numbers, [`NUMBERS`] for each.
pub(super) fn kernels_of(numbers: &[f64]) -> Vec<Kernel> {
    numbers.chunks(NUMBERS).map(Kernel::of).collect()
}
