//! Variances of linear functions of the response, and the uncertainty of these variances.
//!
//! A point of the step response, a real or imaginary part at one frequency and a difference of two
//! points are all w'x for coordinates x, with variance σ² w'(Z_D'Z_D)^-1 w. That variance depends on
//! the fitted D. Satterthwaite's formula turns its relative uncertainty into degrees of freedom:
//!
//! ```text
//! ν = 2 / (g' Cov(D) g + 2/(rows - p - d)),   g = d ln(w'(Z_D'Z_D)^-1 w) / dD
//! ```
//!
//! Under slow noise the width of a bound depends strongly on D. Student's t then widens the bound.

use faer::Mat;

use crate::estimation::GlsFit;
use crate::estimation::least_squares::RowInformation;
use crate::estimation::noise_model::noise_filter;
use crate::numerics::{add_combination, dot, not_negative, student_critical};

/// Standard deviations of linear functions of the response: points of a step response, or real and
/// imaginary parts of a frequency response.
#[derive(Debug, Clone, PartialEq)]
pub struct CurveVariance {
    /// Standard deviation of each.
    pub sd: Vec<f64>,
    /// Degrees of freedom of each standard deviation, as far as it is that of noise.
    pub degrees_of_freedom: Vec<f64>,
    /// Correlation of each with the next; one fewer.
    pub neighbour_correlation: Vec<f64>,
    /// The part that differs from run to run, where there is one.
    pub of_runs: Option<RunPart>,
}

/// The part of a curve's variance that differs from run to run. It has a few directions only, so all points are off
/// together.
#[derive(Debug, Clone, PartialEq)]
pub struct RunPart {
    /// Standard deviation of each, or what it would be if the quantities that scatter did so independently, where that is more.
    pub sd: Vec<f64>,
    /// Standard deviation of each from the noise.
    pub noise_sd: Vec<f64>,
    /// Correlation of the noise of each with that of the next.
    pub noise_correlation: Vec<f64>,
    /// Degrees of freedom: runs less one.
    pub degrees: f64,
}

impl CurveVariance {
    /// Of the functions in the rows of `functions` (f x n, in the coordinates of the fit).
    pub fn of_fit(information: &RowInformation, fit: &GlsFit, functions: &Mat<f64>) -> Self {
        let (f, p) = (functions.nrows(), fit.coordinates.len());
        let inverse = &fit.solution.inverse;
        // One function in each column, for contiguous inner products. The weights are (Z'Z)^-1 w; that
        // of the offset is last.
        let functions = functions.transpose().to_owned();
        let weights = inverse.as_ref().submatrix(0, 0, p + 1, p) * &functions;
        let of_noise: Vec<f64> = (0..f)
            .map(|i| not_negative(dot(weights.col_as_slice(i), functions.col_as_slice(i))))
            .collect();
        let gradients = log_variance_gradients(information, fit, &weights, &of_noise);
        let own = 2.0 / fit.degrees_of_freedom() + fit.further.tails;
        let order = fit.ar.len();
        // Relative variance of a variance.
        let noise = |i: usize| -> f64 {
            let row = |k: usize| -> f64 {
                (0..order)
                    .map(|l| gradients[(k, i)] * fit.ar_covariance[(k, l)] * gradients[(l, i)])
                    .sum()
            };
            not_negative((0..order).map(row).sum()) + own
        };
        let all = match fit.has_even_noise() {
            true => weights,
            false => fit.noise_covariance().as_ref().submatrix(0, 0, p + 1, p) * &functions,
        };
        let slow_end: Vec<f64> = match &fit.further.slow_end {
            Some(moved) => (0..f)
                .map(|i| dot(&moved[..p], functions.col_as_slice(i)))
                .collect(),
            None => vec![0.0; f],
        };
        let product = |i: usize, k: usize| {
            dot(all.col_as_slice(i), functions.col_as_slice(k)) + slow_end[i] * slow_end[k]
        };
        let variance: Vec<f64> = (0..f).map(|i| not_negative(product(i, i))).collect();
        let sd = |v: f64| (fit.variance * v).sqrt();
        let noise_correlation =
            neighbour_correlation(f, product, |i| (variance[i - 1] * variance[i]).sqrt());
        let estimated: Vec<(Mat<f64>, f64)> = (fit.further.estimated.iter())
            .map(|part| {
                let covariance = part.covariance.as_ref().submatrix(0, 0, p + 1, p);
                (covariance * &functions, part.relative_variance)
            })
            .collect();
        let of_estimated = |i: usize| -> f64 {
            let of = |(part, relative_variance): &(Mat<f64>, f64)| {
                let share = dot(part.col_as_slice(i), functions.col_as_slice(i)) / variance[i];
                relative_variance * share * share
            };
            match variance[i] > 0.0 {
                true => estimated.iter().map(of).sum(),
                false => 0.0,
            }
        };
        let noise_degrees: Vec<f64> = (0..f).map(|i| 2.0 / (noise(i) + of_estimated(i))).collect();
        let noise_sd: Vec<f64> = variance.iter().copied().map(sd).collect();
        let Some(spread) = &fit.further.runs else {
            return Self {
                sd: noise_sd,
                degrees_of_freedom: noise_degrees,
                neighbour_correlation: noise_correlation,
                of_runs: None,
            };
        };
        let along = along_directions(&spread.directions, &functions);
        let of_runs = |i: usize, k: usize| dot(along.col_as_slice(i), along.col_as_slice(k));
        let runs: Vec<f64> = (0..f).map(|i| of_runs(i, i)).collect();
        let quantities = along_directions(&spread.quantities, &functions);
        let at_most = |i: usize| runs[i].max(quantities.col(i).squared_norm_l2());
        let sum = |i: usize| variance[i] + runs[i];
        Self {
            sd: (0..f).map(|i| sd(sum(i))).collect(),
            degrees_of_freedom: noise_degrees,
            neighbour_correlation: neighbour_correlation(
                f,
                |i, k| product(i, k) + of_runs(i, k),
                |i| (sum(i - 1) * sum(i)).sqrt(),
            ),
            of_runs: Some(RunPart {
                sd: (0..f).map(|i| sd(at_most(i))).collect(),
                noise_sd,
                noise_correlation,
                degrees: spread.degrees,
            }),
        }
    }

    /// The half width of an interval of each, in its standard deviations, where it is `normal` with endless degrees of freedom.
    ///
    /// Noise and what differs from run to run have their own critical values (Howe, 1974). One for the sum of both, with
    /// degrees of freedom by Satterthwaite, is too small where few runs happen to differ by little: with three runs, intervals of 99 % held 97 %.
    pub fn critical(&self, normal: f64) -> Vec<f64> {
        self.critical_of_parts(normal, normal)
    }

    /// The same where the critical values with endless degrees of freedom are `of_noise` and `of_runs`.
    pub(crate) fn critical_of_parts(&self, of_noise: f64, of_runs: f64) -> Vec<f64> {
        let of_noise = student_critical(of_noise, &self.degrees_of_freedom);
        let Some(runs) = &self.of_runs else {
            return of_noise;
        };
        let of_runs = student_critical(of_runs, &[runs.degrees])[0];
        let both = |(i, of_noise): (usize, f64)| match self.sd[i] > 0.0 {
            true => (of_noise * runs.noise_sd[i]).hypot(of_runs * runs.sd[i]) / self.sd[i],
            false => of_noise,
        };
        of_noise.into_iter().enumerate().map(both).collect()
    }

    /// Of the functions in the rows of `map`, from the covariance of the parameters.
    pub(crate) fn of_functions(
        map: &Mat<f64>,
        covariance: &Mat<f64>,
        degrees_of_freedom: f64,
    ) -> Self {
        let rows = map.transpose().to_owned();
        let weighted = covariance * &rows;
        let product = |i: usize, k: usize| dot(weighted.col_as_slice(i), rows.col_as_slice(k));
        let count = map.nrows();
        let sd: Vec<f64> = (0..count)
            .map(|i| not_negative(product(i, i)).sqrt())
            .collect();
        Self {
            degrees_of_freedom: vec![degrees_of_freedom; count],
            neighbour_correlation: neighbour_correlation(count, product, |i| sd[i - 1] * sd[i]),
            of_runs: None,
            sd,
        }
    }
}

/// Each function along each direction in which runs differ: directions x functions.
fn along_directions(directions: &Mat<f64>, functions: &Mat<f64>) -> Mat<f64> {
    let directions = directions.as_ref();
    directions.subrows(0, functions.nrows()).transpose() * functions
}

/// Correlation of each of `count` functions with the one before it. `scale` is the product of the
/// standard deviations of function i and the one before it.
pub(crate) fn neighbour_correlation(
    count: usize,
    covariance: impl Fn(usize, usize) -> f64,
    scale: impl Fn(usize) -> f64,
) -> Vec<f64> {
    (1..count)
        .map(|i| match scale(i) {
            scale if scale > 0.0 => (covariance(i - 1, i) / scale).clamp(-1.0, 1.0),
            _ => 1.0,
        })
        .collect()
}

/// d ln(w'(Z_D'Z_D)^-1 w) / dD_k = -2 v' (dZ_D/dD_k)' Z_D v / (w'(Z_D'Z_D)^-1 w) for the weights
/// v = (Z_D'Z_D)^-1 w, one in each column of `weights`: d x f.
fn log_variance_gradients(
    information: &RowInformation,
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
    let d = noise_filter(&fit.ar);
    let gain: f64 = d.iter().sum();
    let rows = moments.rows as f64;
    let response = weights.as_ref().submatrix(0, 0, p, f).to_owned();
    // Filtered sums of the input at each lag.
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

/// v' R_s v for each column v of the weights, R_s being R shifted by s lags on one side and filtered by
/// D on the other.
enum ShiftedProducts {
    /// In the coordinates of a bank: the weights, and R_s times the weights for s = 1, 2, ...
    InCoordinates(Mat<f64>, Vec<Mat<f64>>),
    /// By lags: the weights as impulse responses, and R_0 times them, (N+d) x f.
    ByLags(Mat<f64>, Mat<f64>),
}

impl ShiftedProducts {
    /// For `response`, the weights without that of the offset.
    fn new(information: &RowInformation, fit: &GlsFit, d: &[f64], response: Mat<f64>) -> Self {
        if let Some(products) = information.lag_products(&fit.coordinates) {
            let with_weights = |shift: usize| products.filtered(shift, d) * &response;
            let by_shift = (1..d.len()).map(with_weights).collect();
            return Self::InCoordinates(response, by_shift);
        }
        let lags = fit.coordinates.impulses(response);
        let n = fit.coordinates.basis.settling();
        let mut filtered = Mat::<f64>::zeros(n + d.len() - 1, n);
        for b in 0..n {
            let column = |j: usize| information.moments.uu.col_as_slice(b + j);
            add_combination(filtered.col_as_slice_mut(b), d, column);
        }
        let products = filtered * &lags;
        Self::ByLags(lags, products)
    }

    /// For column `i` and a shift of `shift` lags.
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
