//! Least squares with four columns, by orthogonal columns (Gram and Schmidt, each twice, which is as accurate as
//! reflections).

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
    let mut basis = Basis::default();
    let mut units = (0..4).map(|place| std::array::from_fn(|k| f64::from(u8::from(k == place))));
    let kept = columns
        .each_ref()
        .map(|column| basis.add(column, units.next().unwrap_or_default()));
    let [true, true, ..] = kept else {
        return None;
    };
    let (along, residuals) = basis.split(values);
    let (mut coefficients, mut variances) = (
        [0.0; 4],
        kept.map(|kept| if kept { 0.0 } else { f64::INFINITY }),
    );
    for (part, direction) in along.iter().zip(&basis.0) {
        let sums = coefficients.iter_mut().zip(&mut variances);
        for ((coefficient, variance), weight) in sums.zip(direction.weights) {
            *coefficient += part * weight;
            *variance += weight * weight;
        }
    }
    Some(Solution {
        coefficients,
        variances,
        squares: dot(&residuals, &residuals),
        largest_residual: residuals.iter().fold(0.0, |a, x| x.abs().max(a)),
    })
}

/// A vector of length 1, orthogonal to the others.
struct Direction {
    vector: Vec<f64>,
    /// It is the sum of the columns with these weights: a column of R^-1, X = QR.
    weights: [f64; 4],
}

/// Orthogonal directions that span the columns.
#[derive(Default)]
struct Basis(Vec<Direction>);

impl Basis {
    /// Adds a column, unless it is a combination of those before it, and says whether it did. `unit` is the column
    /// as weights.
    fn add(&mut self, column: &[f64], unit: [f64; 4]) -> bool {
        let (along, rest) = self.split(column);
        let (length, rest_length) = (dot(column, column).sqrt(), dot(&rest, &rest).sqrt());
        let is_new = rest_length > 0.0 && rest_length > ROUNDING * length;
        if !is_new || column.len() <= self.0.len() {
            return false;
        }
        let mut weights = unit;
        for (part, direction) in along.iter().zip(&self.0) {
            for (weight, of_direction) in weights.iter_mut().zip(direction.weights) {
                *weight -= part * of_direction;
            }
        }
        self.0.push(Direction {
            vector: rest.iter().map(|x| x / rest_length).collect(),
            weights: weights.map(|weight| weight / rest_length),
        });
        true
    }

    /// The part of a vector along each direction, and the rest.
    fn split(&self, vector: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let (mut along, mut rest) = (vec![0.0; self.0.len()], vector.to_vec());
        for _ in 0..2 {
            for (along, direction) in along.iter_mut().zip(&self.0) {
                let part = dot(&direction.vector, &rest);
                *along += part;
                for (x, q) in rest.iter_mut().zip(&direction.vector) {
                    *x -= part * q;
                }
            }
        }
        (along, rest)
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
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
