//! Least squares from the triangular factor of the rows.

use faer::Mat;

use super::coordinates::Coordinates;
use super::normal_equations::centred_condition;
use super::solution::Solution;
use crate::data::Moments;
use crate::estimation::noise_model::{lagged_filter, noise_filter};
use crate::numerics::{backward_solve, inverse_of_square, upper_factor};

pub(super) fn solve_factor(
    factor: &Mat<f64>,
    moments: &Moments,
    coordinates: &Coordinates,
    ar: &[f64],
) -> Option<Solution> {
    let (lags, n, p) = (
        moments.input_lags(),
        coordinates.basis.settling(),
        coordinates.len(),
    );
    let d = noise_filter(ar);
    let filtered = coordinates.combine(lagged_filter(lags, n, &d));
    // Columns: the filtered regressor, the filtered offset, the filtered output.
    let gain: f64 = d.iter().sum();
    let combination = Mat::from_fn(factor.ncols(), p + 2, |row, k| match (row, k) {
        (row, k) if row < lags && k < p => filtered[(row, k)],
        (row, k) if row == lags && k == p => gain,
        (row, k) if row > lags && k == p + 1 => d.get(row - lags - 1).copied().unwrap_or(0.0),
        _ => 0.0,
    });
    let r = upper_factor(&(factor * combination));
    let triangle = r.as_ref().submatrix(0, 0, p + 1, p + 1).to_owned();
    if (0..=p).any(|k| {
        let norm = triangle.col(k).norm_l2();
        // A column that is a combination of the earlier ones to ten digits carries rounding only.
        norm.is_nan() || triangle[(k, k)].abs() <= 1e-10 * norm
    }) {
        return None;
    }
    let lower = triangle.transpose().to_owned();
    let right: Vec<f64> = (0..=p).map(|k| r[(k, p + 1)]).collect();
    let x = backward_solve(&lower, &right);
    let inverse = inverse_of_square(&lower);
    let a = triangle.transpose() * &triangle;
    let condition = centred_condition(&a, &inverse);
    let rss = if r.nrows() > p + 1 {
        r[(p + 1, p + 1)].powi(2)
    } else {
        0.0
    };
    Some(Solution {
        coordinates: x,
        rss,
        inverse,
        condition,
    })
}
