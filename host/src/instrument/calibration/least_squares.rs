//! Least squares with four columns, by QR.

use faer::linalg::solvers::{Qr, SolveLstsq};
use faer::linalg::triangular_inverse::invert_upper_triangular;
use faer::{Mat, Par};

/// A least-squares fit.
#[derive(Clone, Copy, Debug)]
pub(super) struct Solution {
    /// One for each column; 0 for a column that depends on those before it.
    pub coefficients: [f64; 4],
    /// The diagonal of (X'X)^-1: times σ², the variances of the coefficients. Infinite where a column
    /// depends on those before it.
    pub variances: [f64; 4],
    /// Sum of the squares of the residuals.
    pub squares: f64,
    /// The largest residual.
    pub largest_residual: f64,
}

/// The rest of a column, beside those before it, is rounding when it is this part of the column.
const ROUNDING: f64 = 1e-9;

/// Fits `values` by the columns; `None` where the first two, zero and slope, depend on each other.
pub(super) fn least_squares(columns: &[Vec<f64>; 4], values: &[f64]) -> Option<Solution> {
    let mut kept: Vec<&Vec<f64>> = Vec::new();
    let mut places = [None; 4];
    for (place, column) in places.iter_mut().zip(columns) {
        kept.push(column);
        if adds_something(&kept) {
            *place = Some(kept.len() - 1);
        } else {
            kept.pop();
        }
    }
    let [Some(_), Some(_), ..] = places else {
        return None;
    };
    let design = matrix(&kept);
    let values = matrix(&[&values.to_vec()]);
    let qr = design.qr();
    let solution = qr.solve_lstsq(&values);
    let residuals = &values - &design * &solution;
    let mut inverse = Mat::zeros(kept.len(), kept.len());
    invert_upper_triangular(inverse.as_mut(), qr.thin_R(), Par::Seq);
    Some(Solution {
        coefficients: places.map(|place| place.map_or(0.0, |j| solution[(j, 0)])),
        variances: places.map(|place| {
            // (X'X)^-1 = R^-1 R^-T
            place.map_or(f64::INFINITY, |j| inverse.row(j).squared_norm_l2())
        }),
        squares: residuals.squared_norm_l2(),
        largest_residual: residuals.norm_max(),
    })
}

/// Whether the last column is no combination of those before it.
fn adds_something(columns: &[&Vec<f64>]) -> bool {
    let design = matrix(columns);
    let last = columns.len() - 1;
    let length = design.col(last).norm_l2();
    design.nrows() > last && {
        let qr: Qr<f64> = design.qr();
        let rest = qr.thin_R()[(last, last)].abs();
        rest > ROUNDING * length && rest > 0.0
    }
}

fn matrix(columns: &[&Vec<f64>]) -> Mat<f64> {
    let rows = columns.first().map_or(0, |column| column.len());
    let cell = |i: usize, j: usize| columns.get(j).and_then(|column| column.get(i));
    Mat::from_fn(rows, columns.len(), |i, j| {
        cell(i, j).copied().unwrap_or(f64::NAN)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coefficients_and_variances_are_those_of_the_textbook() {
        let x = [-2.0, -1.0, 0.0, 1.0, 3.0];
        let y = [1.0, 0.0, 2.0, 5.0, 4.0];
        let columns = [vec![1.0; 5], x.to_vec(), vec![0.0; 5], vec![0.0; 5]];
        let found = least_squares(&columns, &y).unwrap();
        // Mean of x 0.2, Σ(x - 0.2)² = 14.8, Σ(x - 0.2)(y - 2.4) = 12.6.
        let slope = 12.6 / 14.8;
        assert!((found.coefficients[1] - slope).abs() < 1e-12);
        assert!((found.coefficients[0] - (2.4 - 0.2 * slope)).abs() < 1e-12);
        assert!((found.variances[1] - 1.0 / 14.8).abs() < 1e-12);
        assert!((found.variances[0] - (0.2 + 0.04 / 14.8)).abs() < 1e-12);
        // Σ(y - 2.4)² = 17.2.
        assert!((found.squares - (17.2 - 12.6 * slope)).abs() < 1e-12);
        assert_eq!(found.variances[2], f64::INFINITY);
    }

    #[test]
    fn four_columns_are_distinguished() {
        let rows = 0..9;
        let column = |of: fn(f64) -> f64| -> Vec<f64> {
            rows.clone().map(|k| of(f64::from(k) - 4.0)).collect()
        };
        let columns = [
            column(|_| 1.0),
            column(|x| x.clamp(-2.0, 1.0)),
            column(|x| (x + 2.0).min(0.0)),
            column(|x| (x - 1.0).max(0.0)),
        ];
        let expected = [3.0, -1.5, 0.25, 7.0];
        let value = |k: usize| (0..4).map(|j| expected[j] * columns[j][k]).sum();
        let values: Vec<f64> = (0..9).map(value).collect();
        let found = least_squares(&columns, &values).unwrap();
        for (found, expected) in found.coefficients.iter().zip(expected) {
            assert!((found - expected).abs() < 1e-12);
        }
        assert!(found.largest_residual < 1e-12);
    }
}
