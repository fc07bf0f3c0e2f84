//! The triangular factor of the rows by blocked QR. It is slower than moments, but accurate where the
//! condition number is too large for them.
//!
//! Z has the rows [u(k)..u(k-L+1) | 1 | y(k)..y(k-J+1)]. Each block of rows is stacked under the factor of
//! all earlier ones and factorised again, so memory is constant. Every D-filtered regressor is a
//! combination of the columns of Z, so one factor serves all noise filters and banks.

use faer::Mat;

use crate::data::{Moments, Record};
use crate::numerics::upper_factor;

/// Upper triangular R with R'R = Z'Z for the complete rows of `record`, with the lags and centre of
/// `template`.
pub fn triangular_factor(record: &Record, template: &Moments) -> Mat<f64> {
    let (lags, outputs) = (template.input_lags(), template.output_lags());
    let width = lags + 1 + outputs;
    // Three widths of new rows with one of the old factor: little work is repeated.
    let block_rows = 3 * width;
    let mut factor = Mat::<f64>::zeros(0, width);
    for run in record.runs() {
        for span in run.complete_rows(lags, outputs) {
            for start in span.clone().step_by(block_rows) {
                let rows = (span.end - start).min(block_rows);
                let old = factor.nrows();
                let stacked = Mat::from_fn(old + rows, width, |i, column| {
                    if i < old {
                        return factor[(i, column)];
                    }
                    let k = start + i - old;
                    match column {
                        a if a < lags => run.input_at(k as isize - a as isize) - template.centre.0,
                        a if a == lags => 1.0,
                        a => run.output()[k - (a - lags - 1)] - template.centre.1,
                    }
                });
                factor = upper_factor(&stacked);
            }
        }
    }
    let mut square = Mat::zeros(width, width);
    square
        .as_mut()
        .submatrix_mut(0, 0, factor.nrows(), width)
        .copy_from(&factor);
    square
}
