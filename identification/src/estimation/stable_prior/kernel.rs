//! The prior covariance of an impulse response that dies out and is smooth.

use crate::numerics::dot;
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

    /// Its entries for a response of so many samples.
    pub(super) fn entries(&self, samples: usize) -> Entries {
        let half_decay = (-0.5 * (-self.log_decay).exp()).exp();
        let likeness = (-(-self.log_length).exp()).exp();
        let power = |of: f64, first: f64| -> Vec<f64> {
            std::iter::successors(Some(first), |value| Some(value * of))
                .take(samples)
                .collect()
        };
        Entries {
            kernel: *self,
            size: self.log_size.exp(),
            decay: power(half_decay, half_decay),
            like: power(likeness, 1.0),
        }
    }
}

/// K of a response: what its entries are products of.
pub(super) struct Entries {
    kernel: Kernel,
    /// c.
    size: f64,
    /// λ^(i/2), i from 1.
    decay: Vec<f64>,
    /// ρ^k, k from 0.
    like: Vec<f64>,
}

impl Entries {
    /// Column `j` of K from its diagonal downwards.
    fn below(&self, j: usize) -> impl Iterator<Item = f64> {
        let scale = self.size * self.decay[j];
        let pairs = self.decay[j..].iter().zip(&self.like);
        pairs.map(move |(decay, like)| scale * decay * like)
    }

    /// Adds the lower triangle of K.
    pub(super) fn add_below(&self, matrix: &mut Mat<f64>) {
        for j in 0..self.decay.len() {
            let column = &mut matrix.col_as_slice_mut(j)[j..];
            for (entry, k) in column.iter_mut().zip(self.below(j)) {
                *entry += k;
            }
        }
    }

    /// Adds K x. With the sums over the samples before and after each, which are the neighbour's times ρ, that is as much work as
    /// there are samples.
    pub(super) fn add_times(&self, x: &[f64], sum: &mut [f64]) {
        let likeness = self.like.get(1).copied().unwrap_or(0.0);
        let scaled: Vec<f64> = self.decay.iter().zip(x).map(|(d, x)| d * x).collect();
        let mut before = 0.0;
        for (i, value) in scaled.iter().enumerate() {
            before = likeness * before + value;
            sum[i] += self.size * self.decay[i] * before;
        }
        let mut after = 0.0;
        for (i, value) in scaled.iter().enumerate().rev() {
            sum[i] += self.size * self.decay[i] * after;
            after = likeness * (after + value);
        }
    }

    /// The sums over the symmetric weights W - xx' times the derivatives of K by its three numbers. Of W the lower triangle is read.
    pub(super) fn weighted_slopes(&self, weights: &Mat<f64>, x: &[f64]) -> [f64; NUMBERS] {
        let samples = x.len();
        let mut sums = [0.0; NUMBERS];
        let mut products = vec![0.0; samples];
        let (ones, apart): (Vec<f64>, Vec<f64>) = (0..samples).map(|i| (1.0, i as f64)).unzip();
        for j in 0..samples {
            let of_column = weights.col_as_slice(j)[j..].iter().zip(&x[j..]);
            let weights = of_column.map(|(weight, with)| weight - x[j] * with);
            let below = &mut products[j..];
            for (product, (k, weight)) in below.iter_mut().zip(self.below(j).zip(weights)) {
                *product = k * weight;
            }
            // What is below the diagonal counts twice. i + j = (i - j) + 2 j.
            let (sum, apart) = (dot(below, &ones), dot(below, &apart));
            let all = 2.0 * sum - below[0];
            sums[0] += all;
            sums[1] += 2.0 * apart + all * (2 * j + 2) as f64;
            sums[2] += 2.0 * apart;
        }
        let decay = (-self.kernel.log_decay).exp();
        let length = (-self.kernel.log_length).exp();
        [sums[0], sums[1] * decay / 2.0, sums[2] * length]
    }
}
