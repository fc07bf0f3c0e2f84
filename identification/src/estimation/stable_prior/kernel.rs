//! The prior covariance of an impulse response that dies out and is smooth.

use faer::Mat;

/// A kernel: K(i, j) = c λ^((i+j)/2) ρ^|i-j|, i and j from 1 ("diagonal/correlated", Chen, Ohlsson and Ljung, Automatica 2012),
/// by the logarithms of three positive numbers: c; the time constant T of the decay, λ = exp(-1/T); and the length R over which
/// neighbours resemble each other, ρ = exp(-1/R) \[samples\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Kernel {
    pub(crate) log_size: f64,
    pub(crate) log_decay: f64,
    pub(crate) log_length: f64,
}

/// Numbers of a kernel.
pub(super) const NUMBERS: usize = 3;

impl Kernel {
    pub(super) fn of(numbers: &[f64]) -> Self {
        Self {
            log_size: numbers[0],
            log_decay: numbers[1],
            log_length: numbers[2],
        }
    }

    pub(super) fn numbers(&self) -> [f64; NUMBERS] {
        [self.log_size, self.log_decay, self.log_length]
    }

    /// T \[samples\].
    pub(crate) fn time_constant(&self) -> f64 {
        self.log_decay.exp()
    }

    /// ln of the variance of the step response at its end, 1'K 1 of a long response, and its derivatives by the numbers. Sums are taken
    /// as integrals: c T 2/(1/R + 1/(2T)).
    pub(super) fn log_step_variance(&self) -> (f64, [f64; NUMBERS]) {
        let (of_length, of_decay) = ((-self.log_length).exp(), 0.5 * (-self.log_decay).exp());
        let both = of_length + of_decay;
        let value = self.log_size + self.log_decay + (2.0 / both).ln();
        (value, [1.0, 1.0 + of_decay / both, of_length / both])
    }

    /// K, `samples` x `samples`.
    pub(super) fn covariance(&self, samples: usize) -> Mat<f64> {
        let half_decay = (-0.5 * (-self.log_decay).exp()).exp();
        let likeness = (-(-self.log_length).exp()).exp();
        let power = |of: f64, last: usize| -> Vec<f64> {
            std::iter::successors(Some(1.0), |value| Some(value * of))
                .take(last + 1)
                .collect()
        };
        let decay = power(half_decay, samples);
        let like = power(likeness, samples);
        let size = self.log_size.exp();
        Mat::from_fn(samples, samples, |i, j| {
            size * decay[i + 1] * decay[j + 1] * like[i.abs_diff(j)]
        })
    }

    /// The sums over `weights` times the derivatives of K by its three numbers.
    pub(super) fn weighted_slopes(
        &self,
        covariance: &Mat<f64>,
        weights: &Mat<f64>,
    ) -> [f64; NUMBERS] {
        let (decay, length) = ((-self.log_decay).exp(), (-self.log_length).exp());
        let mut sums = [0.0; NUMBERS];
        for j in 0..covariance.ncols() {
            let columns = covariance
                .col_as_slice(j)
                .iter()
                .zip(weights.col_as_slice(j));
            for (i, (k, weight)) in columns.enumerate() {
                let product = k * weight;
                sums[0] += product;
                sums[1] += product * (i + j + 2) as f64;
                sums[2] += product * i.abs_diff(j) as f64;
            }
        }
        [sums[0], sums[1] * decay / 2.0, sums[2] * length]
    }
}
