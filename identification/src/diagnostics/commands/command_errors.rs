//! Errors of commands, as moments of the regressors.

use faer::Mat;

use crate::estimation::{GlsFit, noise_filter};
use crate::numerics::dot;

/// Lags at which errors are compared. What they have in common farther apart is that of a level.
pub(super) const LAGS: usize = 16;

/// Samples that are looked at.
pub(super) const EXAMINED: usize = 1 << 16;

/// Sums over the samples of E e(k) e(k+τ) \[input²\], e being what the command in its column is more than what the servo got.
pub(super) struct CommandErrors {
    /// Of each τ below [`LAGS`], less `far`.
    pub(super) near: Vec<f64>,
    /// What errors far apart have in common.
    pub(super) far: f64,
    pub(super) samples: f64,
}

impl CommandErrors {
    /// Errors of both kinds together, of the same samples.
    pub(super) fn with(mut self, other: &Self) -> Self {
        for (near, other) in self.near.iter_mut().zip(&other.near) {
            *near += other;
        }
        self.far += other.far;
        self
    }
}

/// S_ij = sum_k E D e(k-i) D e(k-j), of errors behind D at lags that are as far apart as a place in `filtered`.
pub(super) struct ErrorMoments {
    filtered: Vec<f64>,
    /// Errors one step ahead that are smaller than those of the commands make them show less of these.
    share: f64,
}

impl ErrorMoments {
    pub(super) fn of(errors: &CommandErrors, fit: &GlsFit) -> Self {
        let d = noise_filter(&fit.ar);
        let of_filter = |lag: usize| d.iter().zip(d.iter().skip(lag)).map(|(a, b)| a * b).sum();
        let of_filter: Vec<f64> = (0..d.len()).map(of_filter).collect();
        let mut found = Self {
            filtered: both_sides(&errors.near, &of_filter),
            share: 1.0,
        };
        let impulse = fit.impulse();
        let gain = impulse.iter().sum::<f64>() * d.iter().sum::<f64>();
        let squares = dot(&found.by_lag(&impulse), &impulse) + errors.far * gain * gain;
        found.share = (fit.variance * errors.samples / squares).min(1.0);
        found
    }

    /// S times a vector of the coordinates of `fit`.
    pub(super) fn times(&self, coordinates: &[f64], fit: &GlsFit) -> Vec<f64> {
        let by_lag = self.by_lag(&fit.coordinates.impulse(coordinates));
        let by_lag = Mat::from_fn(by_lag.len(), 1, |i, _| by_lag[i]);
        let compressed = fit.coordinates.compress(by_lag);
        compressed.col(0).iter().copied().collect()
    }

    /// S times an impulse response.
    fn by_lag(&self, impulse: &[f64]) -> Vec<f64> {
        let (lags, reach) = (impulse.len(), self.filtered.len());
        let at = |i: usize| {
            let near = i.saturating_sub(reach - 1)..lags.min(i + reach);
            let sum: f64 = near
                .map(|j| self.filtered[i.abs_diff(j)] * impulse[j])
                .sum();
            self.share * sum
        };
        (0..lags).map(at).collect()
    }
}

/// The convolution of two even functions, of each lag that has any, from 0 on.
fn both_sides(a: &[f64], b: &[f64]) -> Vec<f64> {
    let at = |values: &[f64], lag: usize| values.get(lag).copied().unwrap_or(0.0);
    let lags = a.len() + b.len() - 1;
    let value = |lag: usize| -> f64 {
        let first = b.iter().enumerate();
        first
            .map(|(k, b)| match k {
                0 => b * at(a, lag),
                _ => b * (at(a, lag.abs_diff(k)) + at(a, lag + k)),
            })
            .sum()
    };
    (0..lags).map(value).collect()
}
