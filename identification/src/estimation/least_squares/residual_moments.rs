//! Moments of the residuals of a solution, from the moments of the rows.

use faer::Mat;

use super::coordinates::Coordinates;
use super::row_information::RowInformation;
use crate::data::Moments;
use crate::numerics::dot;

impl RowInformation {
    /// E\[i,j\] = sum v(k-i) v(k-j), i, j = 0..=order, for v = y - h*u - offset (all relative to
    /// the centre).
    pub fn residual_moments(&self, impulse: &[f64], offset: f64, order: usize) -> Mat<f64> {
        match &self.factor {
            None => residual_moments_of_lags(&self.moments, impulse, offset, order),
            Some(factor) => {
                let (lags, n) = (self.moments.input_lags(), impulse.len());
                let combination = Mat::from_fn(factor.ncols(), order + 1, |row, i| match row {
                    row if row < lags && (i..i + n).contains(&row) => -impulse[row - i],
                    row if row == lags => -offset,
                    row if row == lags + 1 + i => 1.0,
                    _ => 0.0,
                });
                let residuals = factor * combination;
                residuals.transpose() * &residuals
            }
        }
    }

    /// [`RowInformation::residual_moments`] of a response in `coordinates`. Known cross moments are reused.
    pub(crate) fn residual_moments_of(
        &self,
        coordinates: &Coordinates,
        response: &[f64],
        offset: f64,
        order: usize,
    ) -> Mat<f64> {
        let impulse = coordinates.impulse(response);
        match self.lag_products(coordinates) {
            Some(products) if self.factor.is_none() => {
                let size = order + 1;
                let modelled = Mat::from_fn(size, size, |i, j| products.quadratic(i, j, response));
                residual_moments(&self.moments, &impulse, offset, &modelled)
            }
            _ => self.residual_moments(&impulse, offset, order),
        }
    }
}

/// [`RowInformation::residual_moments`] from moments.
pub(crate) fn residual_moments_of_lags(
    moments: &Moments,
    impulse: &[f64],
    offset: f64,
    order: usize,
) -> Mat<f64> {
    let modelled = modelled_moments(moments, impulse, order);
    residual_moments(moments, impulse, offset, &modelled)
}

/// sum of s(k-i) s(k-j), i, j = 0..=order, for the modelled output s = h*u.
fn modelled_moments(moments: &Moments, impulse: &[f64], order: usize) -> Mat<f64> {
    let n = impulse.len();
    let lags = n + order;
    let mut late = Mat::<f64>::zeros(lags, order + 1);
    for i in 0..=order {
        late.col_as_slice_mut(i)[i..i + n].copy_from_slice(impulse);
    }
    // The modelled output of lag i against input lag b.
    let response = moments.uu.as_ref().submatrix(0, 0, lags, lags) * late;
    Mat::from_fn(order + 1, order + 1, |i, j| {
        dot(impulse, &response.col_as_slice(i)[j..j + n])
    })
}

/// Moments of the residuals from those of the modelled output.
fn residual_moments(
    moments: &Moments,
    impulse: &[f64],
    offset: f64,
    modelled: &Mat<f64>,
) -> Mat<f64> {
    let n = impulse.len();
    let shifted = |values: &[f64], i: usize| dot(impulse, &values[i..i + n]);
    let output = |i: usize, j: usize| shifted(moments.uy.col_as_slice(j), i);
    let sum = |i: usize| moments.y[i] - shifted(&moments.u, i);
    let rows = moments.rows as f64;
    let mut e = Mat::zeros(modelled.nrows(), modelled.ncols());
    for i in 0..e.nrows() {
        for j in 0..=i {
            let value = moments.yy[(i, j)] - output(i, j) - output(j, i) + modelled[(i, j)]
                - offset * (sum(i) + sum(j))
                + rows * offset * offset;
            e[(i, j)] = value;
            e[(j, i)] = value;
        }
    }
    e
}
