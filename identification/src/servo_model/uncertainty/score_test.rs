//! Score tests: whether the errors of a fit hold what certain columns would leave.
//!
//! The columns are added to the regression of the errors on the derivatives of the fit, all whitened by the noise at
//! rest. If the equation is right, the reduction of the sum of squares over σ² follows χ² with as many degrees of freedom
//! as there are columns (C. R. Rao 1948).

use super::noise_at_rest::NoiseAtRest;
use crate::numerics::{chi_square_upper_tail, cholesky, forward_solve};
use crate::servo_model::descent::error_row::Row;
use crate::thresholds::SERVO_LACK_OF_FIT;
use faer::Mat;

/// What a score test finds.
pub(crate) struct Score {
    /// χ² of all columns.
    chi_square: f64,
    /// Number of columns.
    columns: usize,
    /// What the record knows of the last column's coefficient when all others are free: the reciprocal of its variance.
    pub(crate) information: f64,
    /// That coefficient, in its standard deviations.
    pub(crate) deviations: f64,
}

impl Score {
    /// Whether the columns explain more of the errors than chance does.
    pub(super) fn is_beyond_chance(&self) -> bool {
        chi_square_upper_tail(self.chi_square, self.columns) < SERVO_LACK_OF_FIT
    }

    /// Whether the last column explains more of what the others leave than chance does.
    pub(super) fn last_is_beyond_chance(&self) -> bool {
        chi_square_upper_tail(self.deviations.powi(2), 1) < SERVO_LACK_OF_FIT
    }
}

/// Tests `columns`, by stretch and sample, against the errors of `rows`, whose first `count` derivatives the fit has followed.
pub(crate) fn score_test<const N: usize>(
    rows: &[Vec<Row>],
    count: usize,
    columns: &[Vec<[f64; N]>],
    noise: &NoiseAtRest,
) -> Option<Score> {
    let (normal, products) = whitened_products(rows, count, columns, noise);
    let size = normal.nrows();
    // Columns are scaled to one first; those that are not seen get a small pivot and take nothing.
    let scale = |i: usize| match normal[(i, i)].sqrt() {
        0.0 => 1.0,
        scale => scale,
    };
    let correlation = Mat::from_fn(size, size, |i, j| {
        let (low, high) = (i.min(j), i.max(j));
        let entry = normal[(high, low)] / (scale(low) * scale(high));
        if i == j { entry + PIVOT } else { entry }
    });
    let scaled: Vec<f64> = (0..size).map(|i| products[i] / scale(i)).collect();
    let lower = cholesky(&correlation)?;
    let own = forward_solve(&lower, &scaled);
    let taken: f64 = own[count..].iter().map(|z| z * z).sum();
    let variance = noise.sigma * noise.sigma;
    let last = lower[(size - 1, size - 1)] * scale(size - 1);
    Some(Score {
        chi_square: taken / variance,
        columns: N,
        information: last * last / variance,
        deviations: own[size - 1] / noise.sigma,
    })
}

/// Added to each pivot, so that combinations of other columns take next to nothing.
const PIVOT: f64 = 1e-9;

/// Products of the whitened columns, those of the derivatives first, with each other and with the errors.
fn whitened_products<const N: usize>(
    rows: &[Vec<Row>],
    count: usize,
    columns: &[Vec<[f64; N]>],
    noise: &NoiseAtRest,
) -> (Mat<f64>, Vec<f64>) {
    let (d, all) = (&noise.filter, count + N);
    let mut normal = Mat::<f64>::zeros(all, all);
    let mut products = vec![0.0; all];
    for (rows, columns) in rows.iter().zip(columns) {
        let column = |k: usize, i: usize| match i.checked_sub(count) {
            None => rows[k].slope[i],
            Some(added) => columns[k][added],
        };
        for k in d.len() - 1..rows.len() {
            let white = |of: &dyn Fn(usize) -> f64| -> f64 {
                d.iter().enumerate().map(|(lag, d)| d * of(k - lag)).sum()
            };
            let error = white(&|k| rows[k].error);
            if error.is_nan() {
                continue;
            }
            let row: Vec<f64> = (0..all).map(|i| white(&|k| column(k, i))).collect();
            for i in 0..all {
                products[i] += row[i] * error;
                for j in 0..=i {
                    normal[(i, j)] += row[i] * row[j];
                }
            }
        }
    }
    (normal, products)
}
