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

    /// The sums of x'K'x over the rows x of a matrix, K' being the derivatives of K by its three numbers. `column` gives the column of each
    /// sample, without the rows before that it has nothing in: as many as `rows` at the most, and never more than the one before.
    ///
    /// As in [`Entries::add_times`], what a row has before a sample follows from its neighbour, for all rows together.
    pub(super) fn slopes<'a>(
        &self,
        rows: usize,
        column: impl Fn(usize) -> &'a [f64],
    ) -> [f64; NUMBERS] {
        let likeness = self.like.get(1).copied().unwrap_or(0.0);
        let mut sums = [0.0; NUMBERS];
        // Of each row: the sample, and those before it times ρ^k and times k ρ^k, k samples later.
        let mut states = [(); 3].map(|()| vec![0.0; rows]);
        for (j, decay) in self.decay.iter().enumerate() {
            let column = column(j);
            let [now, before, apart] = states.each_mut().map(|s| &mut s[rows - column.len()..]);
            for (now, x) in now.iter_mut().zip(column) {
                *now = decay * x;
            }
            let all = dot(now, now) + 2.0 * dot(now, before);
            let by_distance = 2.0 * dot(now, apart);
            sums[0] += all;
            // i + j = 2 j - (j - i), both from 1.
            sums[1] += all * (2 * j + 2) as f64 - by_distance;
            sums[2] += by_distance;
            for (before, now) in before.iter_mut().zip(now.iter()) {
                *before = likeness * (*before + now);
            }
            for (apart, before) in apart.iter_mut().zip(before.iter()) {
                *apart = likeness * *apart + before;
            }
        }
        let decay = (-self.kernel.log_decay).exp();
        let length = (-self.kernel.log_length).exp();
        let [all, by_sum, by_distance] = sums.map(|sum| self.size * sum);
        [all, by_sum * decay / 2.0, by_distance * length]
    }
}
