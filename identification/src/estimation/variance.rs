//! Variances of linear functions of the response, and how well each variance is itself known.
//!
//! A point of the step response, a real or imaginary part at one frequency, a difference of two
//! points: each is w'x for coordinates x, with variance σ² w'(Z_D'Z_D)^-1 w. That variance depends on
//! the fitted D; its relative uncertainty turns into degrees of freedom by Satterthwaite's formula
//!
//! ```text
//! ν = 2 / (g' Cov(D) g + 2/(rows - p - d)),   g = d ln(w'(Z_D'Z_D)^-1 w) / dD
//! ```
//!
//! so that slow noise, whose D decides the width of the band, widens it through Student's t.

use faer::Mat;

use crate::estimation::fsf_basis::dot;
use crate::estimation::gls::GlsFit;
use crate::estimation::least_squares::{Information, with_one};

/// Standard deviations of linear functions of the response.
#[derive(Debug, Clone, PartialEq)]
pub struct CurveVariance {
    /// Standard deviation of each.
    pub sd: Vec<f64>,
    /// Degrees of freedom of each.
    pub degrees_of_freedom: Vec<f64>,
    /// Correlation of each with the next; one fewer.
    pub neighbour_correlation: Vec<f64>,
}

/// The spread of the functions in the rows of `functions` (f x n, in the coordinates of the fit).
#[must_use]
pub fn spread(information: &Information, fit: &GlsFit, functions: &Mat<f64>) -> CurveVariance {
    let (f, p) = (functions.nrows(), fit.coordinates.len());
    let inverse = &fit.solution.inverse;
    // One function in each column, for contiguous inner products; its weights (Z'Z)^-1 w, that of
    // the offset last.
    let functions = functions.transpose().to_owned();
    let weights = inverse.as_ref().submatrix(0, 0, p + 1, p) * &functions;
    let product = |i: usize, k: usize| dot(weights.col_as_slice(i), functions.col_as_slice(k));
    let variance: Vec<f64> = (0..f).map(|i| product(i, i).max(0.0)).collect();
    let neighbour_correlation = (1..f)
        .map(|i| {
            let scale = (variance[i - 1] * variance[i]).sqrt();
            if scale > 0.0 {
                (product(i - 1, i) / scale).clamp(-1.0, 1.0)
            } else {
                1.0
            }
        })
        .collect();
    let gradients = log_variance_gradients(information, fit, &weights, &variance);
    let own = 2.0 / fit.degrees_of_freedom();
    let degrees_of_freedom = (0..f)
        .map(|i| {
            let d = fit.ar.len();
            let noise: f64 = (0..d)
                .map(|k| {
                    (0..d)
                        .map(|l| gradients[(k, i)] * fit.ar_covariance[(k, l)] * gradients[(l, i)])
                        .sum::<f64>()
                })
                .sum();
            2.0 / (noise.max(0.0) + own)
        })
        .collect();
    let sd = variance
        .iter()
        .map(|variance| (fit.variance * variance).sqrt())
        .collect();
    CurveVariance {
        sd,
        degrees_of_freedom,
        neighbour_correlation,
    }
}

/// d ln(w'(Z_D'Z_D)^-1 w) / dD_k = -2 v' (dZ_D/dD_k)' Z_D v / (w'(Z_D'Z_D)^-1 w) for the weights
/// v = (Z_D'Z_D)^-1 w, one in each column of `weights`: d x f.
fn log_variance_gradients(
    information: &Information,
    fit: &GlsFit,
    weights: &Mat<f64>,
    variance: &[f64],
) -> Mat<f64> {
    let order = fit.ar.len();
    let f = weights.ncols();
    if order == 0 {
        return Mat::zeros(0, f);
    }
    let moments = &information.moments;
    let (n, p) = (fit.coordinates.basis.settling(), fit.coordinates.len());
    let d = with_one(&fit.ar);
    let gain: f64 = d.iter().sum();
    let rows = moments.rows as f64;
    let response = weights.as_ref().submatrix(0, 0, p, f).to_owned();
    // Input sums at each lag, filtered and moved on by each shift.
    let filtered = |a: usize| -> f64 {
        let terms = d.iter().zip(&moments.u[a..]).map(|(di, u)| di * u);
        terms.sum()
    };
    let sum: Vec<f64> = (0..n).map(filtered).collect();
    let edges = Mat::from_fn(n, order, |a, k| sum[a] + gain * moments.u[a + k + 1]);
    let edges = response.transpose() * fit.coordinates.compress(edges);
    let shifted = ShiftedProducts::new(information, fit, &d, response);
    Mat::from_fn(order, f, |k, i| {
        let offset = weights[(p, i)];
        let constant = offset * offset * gain * rows;
        if variance[i] > 0.0 {
            -2.0 * (shifted.of(i, k + 1) + offset * edges[(i, k)] + constant) / variance[i]
        } else {
            0.0
        }
    })
}

/// v' (R moved on by some lags, its other side filtered) v for each column v of the weights.
enum ShiftedProducts {
    /// In the coordinates of a bank: for each shift from 1 on (c, i) for coordinate c and column i.
    InCoordinates(Mat<f64>, Vec<Mat<f64>>),
    /// By lags: R with one side filtered times the impulse responses, (N+d) x f.
    ByLags(Mat<f64>, Mat<f64>),
}

impl ShiftedProducts {
    /// For the weights `response`, in coordinates.
    fn new(information: &Information, fit: &GlsFit, d: &[f64], response: Mat<f64>) -> Self {
        if let Some(products) = information.lag_products(&fit.coordinates) {
            let with_weights = |shift: usize| products.filtered(shift, d) * &response;
            let by_shift = (1..d.len()).map(with_weights).collect();
            return Self::InCoordinates(response, by_shift);
        }
        let lags = match fit.coordinates.impulse_map() {
            Some(map) => map * response,
            None => response,
        };
        let n = fit.coordinates.basis.settling();
        let mut filtered = Mat::<f64>::zeros(n + d.len() - 1, n);
        for b in 0..n {
            for (j, dj) in d.iter().enumerate() {
                let source = information.moments.uu.col_as_slice(b + j);
                for (target, source) in filtered.col_as_slice_mut(b).iter_mut().zip(source) {
                    *target += dj * source;
                }
            }
        }
        let products = filtered * &lags;
        Self::ByLags(lags, products)
    }

    /// For column `i`, moved on by `shift` lags.
    fn of(&self, i: usize, shift: usize) -> f64 {
        match self {
            Self::InCoordinates(weights, products) => {
                dot(weights.col_as_slice(i), products[shift - 1].col_as_slice(i))
            }
            Self::ByLags(lags, products) => {
                dot(lags.col_as_slice(i), &products.col_as_slice(i)[shift..])
            }
        }
    }
}
