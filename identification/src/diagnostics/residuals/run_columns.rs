//! A further column of each run beside a regression.
//!
//! With the rows Z of the regression, the offset last, and columns W of which each is 0 outside of its run, all behind the noise filter, the coefficients of the columns are
//!
//! ```text
//! (W'W - W'Z (Z'Z)^-1 Z'W)^-1 W'ε
//! ```
//!
//! with the errors ε of the fit without them.

use faer::Mat;

use crate::data::{Moments, Run};
use crate::diagnostics::residuals::filtered_rows::{filtered, only, present, with_history};
use crate::diagnostics::residuals::further_columns::FurtherColumns;
use crate::diagnostics::residuals::simulation_error::Simulated;
use crate::estimation::{GlsFit, noise_filter};
use crate::numerics::{cholesky, dot, inverse_of_square, times};

/// One column of each of some runs.
pub(crate) struct RunColumns {
    /// W, run by run.
    columns: Vec<Vec<f64>>,
    /// (Z'Z)^-1 Z'W.
    weighted: Mat<f64>,
    /// (W'W - W'Z (Z'Z)^-1 Z'W)^-1.
    inverse: Mat<f64>,
}

impl RunColumns {
    /// Runs with their columns, one value a sample. `None` of no run, and where the input explains a column by itself.
    pub(crate) fn new<'a>(
        columns: impl Iterator<Item = (&'a Run<'a>, Vec<f64>)>,
        moments: &Moments,
        fit: &GlsFit,
    ) -> Option<Self> {
        let d = noise_filter(&fit.ar);
        let history = fit.coordinates.basis.settling() + fit.ar.len();
        let (mut own, mut crosses) = (Vec::new(), Vec::new());
        for (run, column) in columns {
            let input = with_history(run, history, moments.centre.0);
            let rows = run.complete_rows(moments.input_lags(), moments.output_lags());
            let column = only(&rows, filtered(&column, &d));
            // Each by itself: products with several columns at once are rounded otherwise.
            let mut cross = FurtherColumns::new(fit, 1);
            cross.add(&filtered(&input, &d), &[0], &[&column]);
            crosses.push(cross.cross_moments());
            own.push(column);
        }
        let cross = Mat::from_fn(crosses.first()?.nrows(), crosses.len(), |i, r| {
            crosses[r][(i, 0)]
        });
        let weighted = &fit.solution.inverse * &cross;
        let explained = cross.transpose() * &weighted;
        let left = Mat::from_fn(own.len(), own.len(), |i, j| {
            let own = if i == j { dot(&own[i], &own[i]) } else { 0.0 };
            own - explained[(i, j)]
        });
        Some(Self {
            inverse: inverse_of_square(&cholesky(&left)?),
            columns: own,
            weighted,
        })
    }

    /// W'ε, of the same runs with their errors.
    pub(crate) fn scores<'a>(
        &self,
        runs: impl Iterator<Item = &'a Simulated<'a>>,
        fit: &GlsFit,
    ) -> Vec<f64> {
        let d = noise_filter(&fit.ar);
        let score = |(run, column): (&Simulated<'_>, &Vec<f64>)| {
            let errors: Vec<f64> = run.errors.iter().copied().map(present).collect();
            dot(column, &filtered(&errors, &d))
        };
        runs.zip(&self.columns).map(score).collect()
    }

    /// The coefficients of the columns by their `scores`.
    pub(crate) fn coefficients(&self, scores: &[f64]) -> Vec<f64> {
        times(&self.inverse, scores)
    }

    /// What the regression with the columns adds to the covariance of its coordinates and offset, for noise of variance 1.
    pub(crate) fn covariance(&self) -> Mat<f64> {
        &self.weighted * &self.inverse * self.weighted.transpose()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnostics::residuals::further_columns::row_by_row::{
        fitted, require_close, summed,
    };

    #[test]
    fn columns_of_runs_are_those_that_rows_make() {
        let (record, moments, fit) = fitted();
        let d = noise_filter(&fit.ar);
        let value = |k: usize| (0.05 * k as f64).sin();
        let column = |run| (run, (0..Run::len(run)).map(value).collect());
        let found = RunColumns::new(record.runs().iter().map(column), &moments, &fit).unwrap();
        let behind = |k: usize| (0..d.len().min(k + 1)).map(|i| d[i] * value(k - i)).sum();
        let slow = [0, 1].map(|of_run| {
            let in_run = |run: usize, k: usize| if run == of_run { behind(k) } else { 0.0 };
            summed(&record, &moments, &fit, in_run)
        });
        let cross = Mat::from_fn(slow[0].cross.len(), 2, |i, run| slow[run].cross[i]);
        let weighted = &fit.solution.inverse * &cross;
        let explained = cross.transpose() * &weighted;
        for run in [0, 1] {
            require_close(found.weighted.col_as_slice(run), weighted.col_as_slice(run));
            require_close(
                &[dot(&found.columns[run], &found.columns[run])],
                &[slow[run].own],
            );
            let left = |other: usize| {
                let own = if run == other { slow[run].own } else { 0.0 };
                own - explained[(run, other)]
            };
            let product = |place: usize| (0..2).map(|i| left(i) * found.inverse[(i, place)]).sum();
            let of_identity = [0, 1].map(|place| f64::from(u8::from(place == run)));
            require_close(&[product(0), product(1)], &of_identity);
        }
    }
}
