//! What the errors of one run have of some columns.

use faer::Mat;

use crate::data::Run;
use crate::estimation::noise_filter;

/// Fewer rows do not characterise a run.
const FEWEST_ROWS: usize = 30;

/// The normal equations of a run's D-filtered errors on columns and a constant, which is last.
pub(super) struct RunEquations {
    /// Products of the columns.
    pub(super) normal: Mat<f64>,
    /// Products of each column with the errors.
    pub(super) right: Vec<f64>,
    /// Sum of the squared errors.
    pub(super) square: f64,
    /// How many rows.
    pub(super) rows: usize,
}

impl RunEquations {
    /// Of columns with a value for each sample of `run`, whose output the model `simulated`, with the noise filter `ar`. Rows with a NaN are left out; `None` for a run
    /// that has too few others.
    pub(super) fn of(
        ar: &[f64],
        run: &Run,
        simulated: &[f64],
        columns: &[Vec<f64>],
    ) -> Option<Self> {
        let order = ar.len();
        let d = noise_filter(ar);
        let filtered = |k: usize, value: &dyn Fn(usize) -> f64| -> f64 {
            d.iter().enumerate().map(|(i, d)| d * value(k - i)).sum()
        };
        let gain: f64 = d.iter().sum();
        let size = columns.len() + 1;
        let mut normal = Mat::<f64>::zeros(size, size);
        let mut right = vec![0.0; size];
        let (mut rows, mut square) = (0, 0.0);
        let mut row = vec![gain; size];
        for k in order..run.len() {
            for (x, column) in row.iter_mut().zip(columns) {
                *x = filtered(k, &|k| column[k]);
            }
            let error = filtered(k, &|k| run.output()[k] - simulated[k]);
            if (row.iter().sum::<f64>() + error).is_nan() {
                continue;
            }
            rows += 1;
            square += error * error;
            for i in 0..size {
                right[i] += row[i] * error;
                for j in 0..size {
                    normal[(i, j)] += row[i] * row[j];
                }
            }
        }
        (rows >= FEWEST_ROWS).then_some(Self {
            normal,
            right,
            square,
            rows,
        })
    }

    /// The same where the constant was eliminated: whatever offset the run has.
    pub(super) fn without_constant(&self) -> Self {
        let last = self.right.len() - 1;
        let share = |i: usize| self.normal[(i, last)] / self.normal[(last, last)];
        Self {
            normal: Mat::from_fn(last, last, |i, j| {
                self.normal[(i, j)] - share(i) * self.normal[(last, j)]
            }),
            right: (0..last)
                .map(|i| self.right[i] - share(i) * self.right[last])
                .collect(),
            ..*self
        }
    }
}
