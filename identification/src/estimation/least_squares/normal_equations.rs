//! The normal equations of D-filtered least squares, and their solution from moments.

use faer::Mat;

use super::coordinates::Coordinates;
use super::solution::Solution;
use crate::data::Moments;
use crate::estimation::noise_model::noise_filter;
use crate::numerics::{
    add_combination, backward_solve, condition, dot, factorised, forward_solve, inverse_of_square,
    mirror, times,
};

/// What D-filtered normal equations have beside the coordinates' part of A.
pub(crate) struct Edges {
    /// Of each coordinate: its products with the filtered output, and with the filtered offset.
    pub(crate) edge: Mat<f64>,
    /// Product of the filtered offset with itself.
    pub(crate) offset_square: f64,
    /// The same with the filtered output.
    pub(crate) offset_output: f64,
    /// Sum of squares of the filtered output.
    pub(crate) c: f64,
}

impl Edges {
    pub(crate) fn new(moments: &Moments, coordinates: &Coordinates, ar: &[f64]) -> Self {
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
        Self {
            edge: coordinates.compress(edge),
            offset_square: gain * gain * moments.rows as f64,
            offset_output: gain * dot(&d, &moments.y),
            c,
        }
    }
}

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
                let mut bordered = lower_input_moments(&moments.uu, n, &d, (0, 1));
                mirror(&mut bordered);
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
        let Edges {
            edge,
            offset_square,
            offset_output,
            c,
        } = Edges::new(moments, coordinates, ar);
        let p = coordinates.len();
        for k in 0..p {
            a[(k, p)] = edge[(k, 1)];
            a[(p, k)] = edge[(k, 1)];
        }
        a[(p, p)] = offset_square;
        let mut b = edge.col_as_slice(0).to_vec();
        b.push(offset_output);
        Self { a, b, c }
    }

    /// A with its diagonal scaled to one, and the scale.
    pub(crate) fn equilibrated(&self) -> (Mat<f64>, Vec<f64>) {
        let p = self.b.len();
        let scale: Vec<f64> = (0..p).map(|k| self.a[(k, k)].sqrt().recip()).collect();
        let mut scaled = self.a.clone();
        scale_both_sides(&mut scaled, &scale);
        (scaled, scale)
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
    let mut products = lower_input_moments(uu, n, d, (0, 0));
    mirror(&mut products);
    products
}

/// The lower triangle of [`filtered_input_moments`], with so many rows and columns of zeros before and after it.
pub(crate) fn lower_input_moments(
    uu: &Mat<f64>,
    n: usize,
    d: &[f64],
    (before, after): (usize, usize),
) -> Mat<f64> {
    // Columns filtered along their lags, of which each is needed by as many columns as D has coefficients.
    let mut once = vec![vec![0.0; n]; d.len()];
    let size = before + n + after;
    let mut products = Mat::<f64>::zeros(size, size);
    for column in 0..n + d.len() - 1 {
        let first = (column + 1).saturating_sub(d.len());
        let filtered = &mut once[column % d.len()][first..];
        filtered.fill(0.0);
        let lags = &uu.col_as_slice(column)[first..];
        add_combination(filtered, d, |i| &lags[i..]);
        // The last column that `first` needs is complete.
        if column + 1 >= d.len() {
            let column = products.col_as_slice_mut(before + first);
            let target = &mut column[before + first..before + n];
            add_combination(target, d, |j| &once[(first + j) % d.len()][first..]);
        }
    }
    products
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
        scale_both_sides(&mut inverse, &self.scale);
        inverse
    }
}

/// Rows and columns of a square matrix times their `scale`.
fn scale_both_sides(matrix: &mut Mat<f64>, scale: &[f64]) {
    for (column, of_column) in scale.iter().enumerate() {
        for (entry, of_row) in matrix.col_as_slice_mut(column).iter_mut().zip(scale) {
            *entry *= of_row * of_column;
        }
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
    let mut centred = a.as_ref().submatrix(0, 0, p, p).to_owned();
    let offset = &a.col_as_slice(p)[..p];
    for (column, of_column) in offset.iter().enumerate() {
        let share = of_column / a[(p, p)];
        for (entry, of_row) in centred.col_as_slice_mut(column).iter_mut().zip(offset) {
            *entry -= of_row * share;
        }
    }
    let block = inverse.as_ref().submatrix(0, 0, p, p).to_owned();
    condition(&centred, &block)
}
