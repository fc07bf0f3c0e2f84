//! Factorisations and products that the estimators share, on top of `faer`.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::{
    LltRegularization, cholesky_in_place, cholesky_in_place_scratch,
};
use faer::linalg::triangular_inverse::invert_lower_triangular;
use faer::linalg::triangular_solve::{
    solve_lower_triangular_in_place, solve_upper_triangular_in_place,
};
use faer::{Mat, Par, Spec};

/// Lower Cholesky factor of a symmetric matrix, `None` when it is not positive definite.
pub(crate) fn cholesky(matrix: &Mat<f64>) -> Option<Mat<f64>> {
    factorised(matrix.clone())
}

/// [`cholesky`] in the place of the matrix, whose lower triangle is read.
pub(crate) fn factorised(matrix: Mat<f64>) -> Option<Mat<f64>> {
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
pub(crate) fn forward_solve(lower: &Mat<f64>, b: &[f64]) -> Vec<f64> {
    let mut x = column(b);
    solve_lower_triangular_in_place(lower.as_ref(), x.as_mut(), Par::Seq);
    x.col_as_slice(0).to_vec()
}

/// L^-T b.
pub(crate) fn backward_solve(lower: &Mat<f64>, b: &[f64]) -> Vec<f64> {
    let mut x = column(b);
    solve_upper_triangular_in_place(lower.transpose(), x.as_mut(), Par::Seq);
    x.col_as_slice(0).to_vec()
}

/// L^-1.
pub(crate) fn inverse_of_lower(lower: &Mat<f64>) -> Mat<f64> {
    let mut inverse = Mat::zeros(lower.nrows(), lower.nrows());
    invert_lower_triangular(inverse.as_mut(), lower.as_ref(), Par::Seq);
    inverse
}

/// (L L')^-1.
pub(crate) fn inverse_of_square(lower: &Mat<f64>) -> Mat<f64> {
    let inverse = inverse_of_lower(lower);
    inverse.transpose() * &inverse
}

/// A column vector.
fn column(values: &[f64]) -> Mat<f64> {
    Mat::from_fn(values.len(), 1, |i, _| values[i])
}

/// The product of a matrix and a vector.
pub(crate) fn times(matrix: &Mat<f64>, vector: &[f64]) -> Vec<f64> {
    (matrix * column(vector)).col_as_slice(0).to_vec()
}

/// Condition number in the 1-norm of a matrix whose inverse is known.
pub(crate) fn condition(matrix: &Mat<f64>, inverse: &Mat<f64>) -> f64 {
    let norm = |matrix: &Mat<f64>| {
        (0..matrix.ncols())
            .map(|j| matrix.col_as_slice(j).iter().map(|x| x.abs()).sum::<f64>())
            .fold(0.0, f64::max)
    };
    norm(matrix) * norm(inverse)
}

/// Adds `sign` times the outer product of `rows` and `columns` to `matrix`.
pub(crate) fn add_outer_product(matrix: &mut Mat<f64>, rows: &[f64], columns: &[f64], sign: f64) {
    for (b, column) in columns.iter().enumerate() {
        let scale = sign * column;
        for (entry, row) in matrix.col_as_slice_mut(b).iter_mut().zip(rows) {
            *entry += scale * row;
        }
    }
}
