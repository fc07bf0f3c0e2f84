//! Factorisations and products of matrices, on top of `faer`.
//!
//! A crate of its own because `faer` is generic: every crate that factorises a matrix compiles the whole of that
//! factorisation again, for several sets of instructions. Behind these functions it is compiled once.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::{
    LltRegularization, cholesky_in_place, cholesky_in_place_scratch,
};
use faer::linalg::matmul::triangular::{self, BlockStructure};
use faer::linalg::triangular_inverse::invert_lower_triangular;
use faer::linalg::triangular_solve::{
    solve_lower_triangular_in_place, solve_upper_triangular_in_place,
};
use faer::{Accum, Mat, Par, Side, Spec};

/// Lower Cholesky factor of a symmetric matrix, `None` when it is not positive definite.
#[must_use]
pub fn cholesky(matrix: &Mat<f64>) -> Option<Mat<f64>> {
    factorised(matrix.clone())
}

/// [`cholesky`] in the place of the matrix, whose lower triangle is read.
#[must_use]
pub fn factorised(matrix: Mat<f64>) -> Option<Mat<f64>> {
    let mut lower = matrix;
    let size = lower.nrows();
    if size == 0 {
        return Some(lower);
    }
    let scratch = cholesky_in_place_scratch::<f64>(size, Par::Seq, Spec::default());
    cholesky_in_place(
        lower.as_mut(),
        LltRegularization::default(),
        Par::Seq,
        MemStack::new(&mut MemBuffer::new(scratch)),
        Spec::default(),
    )
    .ok()?;
    for column in 1..size {
        lower.col_as_slice_mut(column)[..column].fill(0.0);
    }
    // Rounding can give a singular matrix a meaningless last pivot.
    (0..lower.nrows())
        .all(|i| lower[(i, i)].is_finite() && lower[(i, i)] > 0.0)
        .then_some(lower)
}

/// L^-1 b.
#[must_use]
pub fn forward_solve(lower: &Mat<f64>, b: &[f64]) -> Vec<f64> {
    let mut x = column(b);
    solve_lower_triangular_in_place(lower.as_ref(), x.as_mut(), Par::Seq);
    x.col_as_slice(0).to_vec()
}

/// L^-T b.
#[must_use]
pub fn backward_solve(lower: &Mat<f64>, b: &[f64]) -> Vec<f64> {
    let mut x = column(b);
    solve_upper_triangular_in_place(lower.transpose(), x.as_mut(), Par::Seq);
    x.col_as_slice(0).to_vec()
}

/// L^-1.
#[must_use]
pub fn inverse_of_lower(lower: &Mat<f64>) -> Mat<f64> {
    let mut inverse = Mat::zeros(lower.nrows(), lower.nrows());
    invert_lower_triangular(inverse.as_mut(), lower.as_ref(), Par::Seq);
    inverse
}

/// (L L')^-1.
#[must_use]
pub fn inverse_of_square(lower: &Mat<f64>) -> Mat<f64> {
    let mut square = lower_inverse_of_square(lower);
    mirror(&mut square);
    square
}

/// The lower triangle of (L L')^-1.
#[must_use]
fn lower_inverse_of_square(lower: &Mat<f64>) -> Mat<f64> {
    let inverse = inverse_of_lower(lower);
    let mut square = Mat::zeros(lower.nrows(), lower.nrows());
    // A sixth of the operations of a general product: both factors are triangular, and half of a symmetric result is enough.
    triangular::matmul(
        square.as_mut(),
        BlockStructure::TriangularLower,
        Accum::Replace,
        inverse.transpose(),
        BlockStructure::TriangularUpper,
        inverse.as_ref(),
        BlockStructure::TriangularLower,
        1.0,
        Par::Seq,
    );
    square
}

/// A A', of which half is computed.
#[must_use]
pub fn outer_square(matrix: &Mat<f64>) -> Mat<f64> {
    let mut square = Mat::zeros(matrix.nrows(), matrix.nrows());
    triangular::matmul(
        square.as_mut(),
        BlockStructure::TriangularLower,
        Accum::Replace,
        matrix.as_ref(),
        BlockStructure::Rectangular,
        matrix.transpose(),
        BlockStructure::Rectangular,
        1.0,
        Par::Seq,
    );
    mirror(&mut square);
    square
}

/// Copies the lower triangle of a square matrix into the upper one. In tiles, whose columns stay at hand while they are
/// read across.
pub fn mirror(matrix: &mut Mat<f64>) {
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

/// Upper triangular R of the QR factorisation: R'R = A'A. It has as many rows as A where A has fewer rows than columns.
#[must_use]
pub fn upper_factor(matrix: &Mat<f64>) -> Mat<f64> {
    matrix.qr().thin_R().to_owned()
}

/// Eigenvalues and eigenvectors of a symmetric matrix.
#[derive(Clone, Debug)]
pub struct SymmetricEigen {
    /// Eigenvalues, in ascending order.
    pub values: Vec<f64>,
    /// The eigenvector of each value, as the column of the same number; of length 1 and orthogonal to the others.
    pub vectors: Mat<f64>,
}

/// The eigenvalues and eigenvectors of a symmetric matrix, of which the lower triangle is read; `None` where the iteration
/// does not end, as with entries that are not finite.
#[must_use]
pub fn symmetric_eigen(matrix: &Mat<f64>) -> Option<SymmetricEigen> {
    let eigen = matrix.self_adjoint_eigen(Side::Lower).ok()?;
    Some(SymmetricEigen {
        values: eigen.S().column_vector().iter().copied().collect(),
        vectors: eigen.U().to_owned(),
    })
}

/// The largest magnitude of an eigenvalue of a square matrix; not a number where the iteration does not end.
#[must_use]
pub fn spectral_radius(matrix: &Mat<f64>) -> f64 {
    matrix.eigenvalues().map_or(f64::NAN, |values| {
        values.iter().map(|value| value.norm()).fold(0.0, f64::max)
    })
}

/// A column vector.
fn column(values: &[f64]) -> Mat<f64> {
    Mat::from_fn(values.len(), 1, |i, _| values[i])
}

/// The product of a matrix and a vector.
#[must_use]
pub fn times(matrix: &Mat<f64>, vector: &[f64]) -> Vec<f64> {
    (matrix * column(vector)).col_as_slice(0).to_vec()
}

/// Condition number in the 1-norm of a matrix whose inverse is known.
#[must_use]
pub fn condition(matrix: &Mat<f64>, inverse: &Mat<f64>) -> f64 {
    let norm = |matrix: &Mat<f64>| {
        (0..matrix.ncols())
            .map(|j| matrix.col_as_slice(j).iter().map(|x| x.abs()).sum::<f64>())
            .fold(0.0, f64::max)
    };
    norm(matrix) * norm(inverse)
}

/// Adds `sign` times the outer product of `rows` and `columns` to `matrix`.
pub fn add_outer_product(matrix: &mut Mat<f64>, rows: &[f64], columns: &[f64], sign: f64) {
    for (b, column) in columns.iter().enumerate() {
        let scale = sign * column;
        for (entry, row) in matrix.col_as_slice_mut(b).iter_mut().zip(rows) {
            *entry += scale * row;
        }
    }
}
