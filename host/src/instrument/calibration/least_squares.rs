//! Least squares with four columns, by modified Gram-Schmidt (Å. Björck, *Numerical Methods for Least
//! Squares Problems*, 1996, §2.4).

#![allow(
    clippy::indexing_slicing,
    reason = "four columns, as the types say, and loops over four"
)]

/// What least squares give.
#[derive(Clone, Copy, Debug)]
pub(super) struct Solution {
    /// One for each column; 0 for a column that says nothing beside those before it.
    pub coefficients: [f64; 4],
    /// The diagonal of (X'X)^-1: times σ², the variances of the coefficients. Infinite where a column says
    /// nothing.
    pub variances: [f64; 4],
    /// Sum of the squares of the residuals.
    pub squares: f64,
    /// The largest residual.
    pub largest_residual: f64,
}

/// What is left of a column is rounding when it is this part of what it was.
const ROUNDING: f64 = 1e-9;

/// Fits `values` by the columns; `None` where the first two, zero and slope, cannot be told apart.
pub(super) fn least_squares(
    columns: &[Vec<f64>; 4],
    values: impl Iterator<Item = f64>,
) -> Option<Solution> {
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let mut directions = columns.clone();
    let mut triangle = [[0.0; 4]; 4];
    let mut told = [false; 4];
    let mut residuals: Vec<f64> = values.collect();
    let mut projections = [0.0; 4];
    for j in 0..4 {
        for i in 0..j {
            let part = dot(&directions[i], &directions[j]);
            triangle[i][j] = part;
            let earlier = directions[i].clone();
            let column = directions[j].iter_mut().zip(earlier);
            column.for_each(|(x, q)| *x -= part * q);
        }
        let left = dot(&directions[j], &directions[j]).sqrt();
        told[j] = left > ROUNDING * dot(&columns[j], &columns[j]).sqrt() && left > 0.0;
        if !told[j] {
            directions[j].fill(0.0);
            triangle[j][j] = 1.0;
            continue;
        }
        triangle[j][j] = left;
        directions[j].iter_mut().for_each(|x| *x /= left);
        projections[j] = dot(&directions[j], &residuals);
        let fitted = directions[j].iter().map(|q| projections[j] * q);
        residuals.iter_mut().zip(fitted).for_each(|(r, f)| *r -= f);
    }
    let inverse = inverse(&triangle);
    let row = |i: usize| (i..4).filter(|&j| told[j]).map(move |j| (j, inverse[i][j]));
    let coefficient = |i| row(i).map(|(j, part)| part * projections[j]).sum();
    let variance = |i| match told[i] {
        true => row(i).map(|(_, part)| part * part).sum(),
        false => f64::INFINITY,
    };
    (told[0] && told[1]).then(|| Solution {
        coefficients: std::array::from_fn(|i| if told[i] { coefficient(i) } else { 0.0 }),
        variances: std::array::from_fn(variance),
        squares: dot(&residuals, &residuals),
        largest_residual: residuals.iter().map(|r| r.abs()).fold(0.0, f64::max),
    })
}

/// Of an upper triangle.
fn inverse(triangle: &[[f64; 4]; 4]) -> [[f64; 4]; 4] {
    let mut inverse = [[0.0; 4]; 4];
    for j in 0..4 {
        inverse[j][j] = 1.0 / triangle[j][j];
        for i in (0..j).rev() {
            let sum: f64 = (i + 1..=j).map(|k| triangle[i][k] * inverse[k][j]).sum();
            inverse[i][j] = -sum / triangle[i][i];
        }
    }
    inverse
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coefficients_and_variances_are_those_of_the_textbook() {
        let x = [-2.0, -1.0, 0.0, 1.0, 3.0];
        let y = [1.0, 0.0, 2.0, 5.0, 4.0];
        let columns = [vec![1.0; 5], x.to_vec(), vec![0.0; 5], vec![0.0; 5]];
        let found = least_squares(&columns, y.into_iter()).unwrap();
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
    fn four_columns_are_told_apart() {
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
        let found = least_squares(&columns, (0..9).map(value)).unwrap();
        for (found, expected) in found.coefficients.iter().zip(expected) {
            assert!((found - expected).abs() < 1e-12);
        }
        assert!(found.largest_residual < 1e-12);
    }
}
