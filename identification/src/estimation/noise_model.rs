//! The noise model v = ε/D(z), D(z) = 1 + d_1 z^-1 + ... + d_d z^-d.
//!
//! D is fitted by least squares to the residuals of the response model, from their lagged moments
//! E\[i,j\] = sum v(k-i) v(k-j) over the same rows (the covariance method), so that both half steps of
//! generalised least squares lower the same sum of squares.

use faer::Mat;
use serde::{Deserialize, Serialize};

use crate::numerics::{cholesky, forward_solve, inverse_of_square, spectral_radius};

/// The noise of a model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Noise {
    /// d_1..d_d of D(z) = 1 + d_1 z^-1 + ...
    pub ar: Vec<f64>,
    /// Standard deviation of ε.
    pub sigma: f64,
}

impl Noise {
    /// Largest magnitude of the roots of D(z), 0 for white noise. From 1 on the modelled noise grows without bound; near 1 it drifts.
    #[must_use]
    pub fn largest_root(&self) -> f64 {
        largest_root(&self.ar)
    }
}

/// The coefficients 1, d_1, ..., d_d of the noise filter D.
pub(crate) fn noise_filter(ar: &[f64]) -> Vec<f64> {
    std::iter::once(1.0).chain(ar.iter().copied()).collect()
}

/// D for each of the first `settling` lags of a row that has `lags`, one in each column.
pub(crate) fn lagged_filter(lags: usize, settling: usize, d: &[f64]) -> Mat<f64> {
    Mat::from_fn(lags, settling, |row, lag| {
        let late = row.checked_sub(lag);
        late.and_then(|i| d.get(i)).copied().unwrap_or(0.0)
    })
}

/// A fit of D for every order up to that of the moments.
pub(crate) struct NoiseFit {
    lower: Mat<f64>,
    /// L^-1 E[1..,0].
    projected: Vec<f64>,
    total: f64,
}

impl NoiseFit {
    /// Factorises the residual moments E, (d+1) x (d+1). `None` when the residuals are rounding only, so
    /// that there is no noise to model.
    pub(crate) fn new(residual_moments: &Mat<f64>, output_spread: f64) -> Option<Self> {
        let order = residual_moments.nrows() - 1;
        let total = residual_moments[(0, 0)];
        // Residuals of 1e-13 of the output are rounding, not noise.
        if total.is_nan() || total <= 1e-26 * output_spread {
            return None;
        }
        let past = residual_moments.as_ref().submatrix(1, 1, order, order);
        let lower = cholesky(&past.to_owned())?;
        let now: Vec<f64> = (0..order).map(|i| residual_moments[(i + 1, 0)]).collect();
        let projected = forward_solve(&lower, &now);
        Some(Self {
            lower,
            projected,
            total,
        })
    }

    /// Sum of squares of ε for the first `order` coefficients.
    pub(super) fn rss(&self, order: usize) -> f64 {
        self.total - self.projected[..order].iter().map(|z| z * z).sum::<f64>()
    }

    /// The highest order that there is a fit for.
    pub(super) fn highest_order(&self) -> usize {
        self.projected.len()
    }

    /// d_1..d_d.
    pub(crate) fn coefficients(&self, order: usize) -> Vec<f64> {
        let mut solution = self.projected[..order].to_vec();
        for i in (0..order).rev() {
            let later: f64 = (i + 1..order)
                .map(|k| self.lower[(k, i)] * solution[k])
                .sum();
            solution[i] = (solution[i] - later) / self.lower[(i, i)];
        }
        solution.iter().map(|x| -x).collect()
    }

    /// Covariance of d_1..d_d per unit variance of ε.
    pub(crate) fn unit_covariance(&self, order: usize) -> Mat<f64> {
        let lower = self.lower.as_ref().submatrix(0, 0, order, order).to_owned();
        inverse_of_square(&lower)
    }
}

fn largest_root(ar: &[f64]) -> f64 {
    let order = ar.len();
    if order == 0 {
        return 0.0;
    }
    let companion = Mat::from_fn(order, order, |i, j| {
        if i == 0 {
            -ar[j]
        } else {
            f64::from(u8::from(i == j + 1))
        }
    });
    spectral_radius(&companion)
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_abs_diff_eq;

    #[test]
    fn nested_orders_agree_with_solving_each() {
        let e = Mat::from_fn(4, 4, |i, j| 0.8f64.powi((i as i32 - j as i32).abs()) * 50.0);
        let fit = NoiseFit::new(&e, 1.0).unwrap();
        // An exponentially correlated residual is AR(1): -0.8, and nothing more to gain.
        let ar = fit.coefficients(3);
        assert_abs_diff_eq!(ar[0], -0.8, epsilon = 1e-12);
        assert_abs_diff_eq!(ar[1], 0.0, epsilon = 1e-12);
        assert_abs_diff_eq!(fit.unit_covariance(1)[(0, 0)], 1.0 / 50.0, epsilon = 1e-15);
    }

    #[test]
    fn the_root_of_a_slow_noise_is_close_to_one() {
        assert_abs_diff_eq!(largest_root(&[-0.95]), 0.95, epsilon = 1e-12);
        // 1 - 1.5 z^-1 + 0.7 z^-2: a pair of modulus sqrt(0.7).
        assert_abs_diff_eq!(largest_root(&[-1.5, 0.7]), 0.7f64.sqrt(), epsilon = 1e-12);
    }
}
