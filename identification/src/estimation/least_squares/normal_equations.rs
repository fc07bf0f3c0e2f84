//! The normal equations of D-filtered least squares, and their solution from moments.

use faer::Mat;

use super::coordinates::Coordinates;
use super::solution::Solution;
use crate::data::Moments;
use crate::estimation::noise_model::noise_filter;
use crate::numerics::{
    backward_solve, condition, dot, factorised, forward_solve, inverse_of_square, times,
};

/// D-filtered normal equations A x = b with the offset as last parameter.
pub(crate) struct NormalEquations {
    pub(crate) a: Mat<f64>,
    pub(crate) b: Vec<f64>,
    /// Sum of squares of the filtered output.
    pub(crate) c: f64,
}

impl NormalEquations {
    pub(crate) fn new(moments: &Moments, coordinates: &Coordinates, ar: &[f64]) -> Self {
        let (n, d) = (coordinates.basis.settling(), noise_filter(ar));
        match coordinates.impulse_map() {
            None => {
                let bordered = bordered_input_moments(&moments.uu, n, &d, 1);
                Self::with_bordered(moments, coordinates, ar, bordered)
            }
            Some(_) => {
                let square = coordinates.square(filtered_input_moments(&moments.uu, n, &d));
                Self::with_square(moments, coordinates, ar, &square)
            }
        }
    }

    /// With a known coordinates' part of A.
    pub(crate) fn with_square(
        moments: &Moments,
        coordinates: &Coordinates,
        ar: &[f64],
        square: &Mat<f64>,
    ) -> Self {
        let p = coordinates.len();
        let mut a = Mat::zeros(p + 1, p + 1);
        a.as_mut().submatrix_mut(0, 0, p, p).copy_from(square);
        Self::with_bordered(moments, coordinates, ar, a)
    }

    /// With a known coordinates' part of A, and room for the offset.
    fn with_bordered(
        moments: &Moments,
        coordinates: &Coordinates,
        ar: &[f64],
        mut a: Mat<f64>,
    ) -> Self {
        let n = coordinates.basis.settling();
        let d = noise_filter(ar);
        let gain: f64 = d.iter().sum();
        // Columns: cross moments with the filtered output, and with the filtered offset.
        let mut edge = Mat::<f64>::zeros(n, 2);
        for (i, di) in d.iter().enumerate() {
            for (j, dj) in d.iter().enumerate() {
                let output = &moments.uy.col_as_slice(j)[i..];
                for (sum, uy) in edge.col_as_slice_mut(0).iter_mut().zip(output) {
                    *sum += di * dj * uy;
                }
            }
            for (sum, u) in edge.col_as_slice_mut(1).iter_mut().zip(&moments.u[i..]) {
                *sum += di * gain * u;
            }
        }
        let edge = coordinates.compress(edge);
        let p = coordinates.len();
        for k in 0..p {
            a[(k, p)] = edge[(k, 1)];
            a[(p, k)] = edge[(k, 1)];
        }
        a[(p, p)] = gain * gain * moments.rows as f64;
        let mut b: Vec<f64> = (0..p).map(|k| edge[(k, 0)]).collect();
        b.push(gain * dot(&d, &moments.y));
        let c = d
            .iter()
            .enumerate()
            .map(|(i, di)| {
                di * d
                    .iter()
                    .enumerate()
                    .map(|(j, dj)| dj * moments.yy[(i, j)])
                    .sum::<f64>()
            })
            .sum();
        Self { a, b, c }
    }

    /// A with its diagonal scaled to one, and the scale.
    pub(crate) fn equilibrated(&self) -> (Mat<f64>, Vec<f64>) {
        let p = self.b.len();
        let scale: Vec<f64> = (0..p).map(|k| self.a[(k, k)].sqrt().recip()).collect();
        (
            Mat::from_fn(p, p, |i, j| self.a[(i, j)] * scale[i] * scale[j]),
            scale,
        )
    }
}

/// Residual sum of squares of the complete bank for `settling` samples, the smallest of any response of
/// that length. `None` when the rows do not determine it.
pub(crate) fn complete_bank_rss(moments: &Moments, settling: usize) -> Option<f64> {
    let n = settling;
    let a = Mat::from_fn(n + 1, n + 1, |i, j| match (i, j) {
        (i, j) if i < n && j < n => moments.uu[(i, j)],
        (k, other) | (other, k) if k < n && other == n => moments.u[k],
        _ => moments.rows as f64,
    });
    let mut b = moments.uy.col_as_slice(0)[..n].to_vec();
    b.push(moments.y[0]);
    let equations = NormalEquations {
        a,
        b,
        c: moments.yy[(0, 0)],
    };
    let (scaled, scale) = equations.equilibrated();
    let right: Vec<f64> = equations.b.iter().zip(&scale).map(|(b, s)| b * s).collect();
    let projected = forward_solve(&factorised(scaled)?, &right);
    Some(equations.c - dot(&projected, &projected))
}

/// sum_ij d_i d_j R[i:i+N, j:j+N].
pub(crate) fn filtered_input_moments(uu: &Mat<f64>, n: usize, d: &[f64]) -> Mat<f64> {
    bordered_input_moments(uu, n, d, 0)
}

/// [`filtered_input_moments`], and as many further rows and columns of zeros.
fn bordered_input_moments(uu: &Mat<f64>, n: usize, d: &[f64], border: usize) -> Mat<f64> {
    // Columns filtered along their lags, of which each is needed by as many columns as D has coefficients.
    let mut once = vec![vec![0.0; n]; d.len()];
    let mut products = Mat::<f64>::zeros(n + border, n + border);
    for column in 0..n + d.len() - 1 {
        let first = (column + 1).saturating_sub(d.len());
        let filtered = &mut once[column % d.len()][first..];
        filtered.fill(0.0);
        for (i, di) in d.iter().enumerate() {
            let source = &uu.col_as_slice(column)[first + i..];
            for (target, source) in filtered.iter_mut().zip(source) {
                *target += di * source;
            }
        }
        // The last column that `first` needs is complete.
        if column + 1 >= d.len() {
            let target = &mut products.col_as_slice_mut(first)[first..n];
            for (j, dj) in d.iter().enumerate() {
                let source = &once[(first + j) % d.len()][first..];
                for (target, source) in target.iter_mut().zip(source) {
                    *target += dj * source;
                }
            }
        }
    }
    mirror(&mut products);
    products
}

/// Copies the lower triangle of a square matrix into the upper one. In tiles, whose columns stay at hand while they are
/// read across.
fn mirror(matrix: &mut Mat<f64>) {
    const TILE: usize = 32;
    let size = matrix.nrows();
    for start in (0..size).step_by(TILE) {
        let rows = start..(start + TILE).min(size);
        for column in start + 1..size {
            for row in rows.start..rows.end.min(column) {
                matrix[(row, column)] = matrix[(column, row)];
            }
        }
    }
}

/// Cholesky factor of equilibrated normal equations.
pub(super) struct Factored {
    lower: Mat<f64>,
    scale: Vec<f64>,
}

impl Factored {
    pub(super) fn new(equations: &NormalEquations) -> Option<Self> {
        let (scaled, scale) = equations.equilibrated();
        factorised(scaled).map(|lower| Self { lower, scale })
    }

    fn solve(&self, b: &[f64]) -> Vec<f64> {
        let b: Vec<f64> = b.iter().zip(&self.scale).map(|(b, s)| b * s).collect();
        let x = backward_solve(&self.lower, &forward_solve(&self.lower, &b));
        x.iter().zip(&self.scale).map(|(x, s)| x * s).collect()
    }

    /// A^-1 b, refined once.
    pub(super) fn refined(&self, equations: &NormalEquations) -> Vec<f64> {
        let mut x = self.solve(&equations.b);
        let product = times(&equations.a, &x);
        let left: Vec<f64> = equations
            .b
            .iter()
            .zip(&product)
            .map(|(b, ax)| b - ax)
            .collect();
        for (x, correction) in x.iter_mut().zip(self.solve(&left)) {
            *x += correction;
        }
        x
    }

    fn inverse(&self) -> Mat<f64> {
        let mut inverse = inverse_of_square(&self.lower);
        for j in 0..self.scale.len() {
            for i in 0..self.scale.len() {
                inverse[(i, j)] *= self.scale[i] * self.scale[j];
            }
        }
        inverse
    }
}

pub(crate) fn solve_moments(equations: &NormalEquations) -> Option<Solution> {
    let factored = Factored::new(equations)?;
    let x = factored.refined(equations);
    // In c - 2 b'x + x'A x the error of x has only second-order effects.
    let rss = equations.c - 2.0 * dot(&equations.b, &x) + dot(&x, &times(&equations.a, &x));
    let inverse = factored.inverse();
    let condition = centred_condition(&equations.a, &inverse);
    Some(Solution {
        coordinates: x,
        rss: rss.max(0.0),
        inverse,
        condition,
    })
}

/// Condition number of the coordinates' part of A, the offset (last) projected out.
pub(super) fn centred_condition(a: &Mat<f64>, inverse: &Mat<f64>) -> f64 {
    let p = a.nrows() - 1;
    let centred = Mat::from_fn(p, p, |i, j| a[(i, j)] - a[(i, p)] * a[(p, j)] / a[(p, p)]);
    let block = inverse.as_ref().submatrix(0, 0, p, p).to_owned();
    condition(&centred, &block)
}
