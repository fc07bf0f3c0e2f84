//! Parameters and covariance of a direction-split model.

use faer::Mat;

use super::two_inputs::{TwoInputFit, TwoInputMoments};
use crate::data::Run;
use crate::estimation::{Coordinates, FsfBasis};
use crate::numerics::{causal_filter, dot, times};

/// Parameters and covariance of the fit, from which models are compared.
#[derive(Debug, Clone)]
pub(crate) struct SplitFit {
    /// Coordinates of the response to u, parameters of δ, offset about the centre.
    pub(crate) parameters: Vec<f64>,
    pub(crate) covariance: Mat<f64>,
    /// From parameters to g, N rows.
    pub(crate) step_map: Mat<f64>,
    /// From parameters to δ, N rows.
    pub(crate) split_map: Mat<f64>,
    centre: (f64, f64, f64),
    pub(crate) degrees_of_freedom: f64,
    /// Places of the parameters of δ.
    pub(super) of_changes: std::ops::Range<usize>,
}

impl SplitFit {
    pub(super) fn new(
        moments: &TwoInputMoments,
        coordinates: &Coordinates,
        second: &FsfBasis,
        fit: &TwoInputFit,
    ) -> Self {
        let (n, n2) = (coordinates.len(), second.frequencies());
        let p = n + n2 + 1;
        let (step, impulse) = (coordinates.step_map(), second.impulse_map());
        let within = |columns: std::ops::Range<usize>, map: &Mat<f64>| {
            Mat::from_fn(step.nrows(), p, |m, k| {
                if columns.contains(&k) {
                    map[(m, k - columns.start)]
                } else {
                    0.0
                }
            })
        };
        Self {
            step_map: within(0..n, &step),
            split_map: within(n..n + n2, &impulse),
            parameters: fit.parameters.clone(),
            covariance: fit.covariance.clone(),
            centre: moments.centre,
            degrees_of_freedom: fit.degrees_of_freedom,
            of_changes: n..n + n2,
        }
    }

    /// Rows of g_up, then of g_down: 2N x p.
    pub(crate) fn curves_map(&self) -> Mat<f64> {
        let n = self.step_map.nrows();
        Mat::from_fn(2 * n, self.step_map.ncols(), |i, k| {
            let sign = if i < n { 1.0 } else { -1.0 };
            self.step_map[(i % n, k)] + sign * self.split_map[(i % n, k)]
        })
    }

    pub(super) fn simulate(&self, run: &Run) -> Vec<f64> {
        let step = self.mean_step();
        let before = std::iter::once(&0.0).chain(&step);
        let impulse: Vec<f64> = step.iter().zip(before).map(|(g, b)| g - b).collect();
        let (input, at_rest) = (run.input(), run.input_at_rest());
        let earlier = std::iter::once(at_rest.unwrap_or(f64::NAN)).chain(input.iter().copied());
        let changes: Vec<f64> = input
            .iter()
            .zip(earlier)
            .map(|(u, before)| (u - before).abs())
            .collect();
        let by_level = causal_filter(&impulse, input, at_rest);
        let split = times(&self.split_map, &self.parameters);
        let by_changes = causal_filter(&split, &changes, at_rest.map(|_| 0.0));
        let offset = self.offset();
        let both = by_level.iter().zip(by_changes);
        both.map(|(a, b)| a + b + offset).collect()
    }

    pub(super) fn mean_step(&self) -> Vec<f64> {
        times(&self.step_map, &self.parameters)
    }

    /// The final value of strokes up and down.
    pub(super) fn gain(&self) -> f64 {
        self.mean_step().last().copied().unwrap_or(0.0)
    }

    pub(super) fn offset(&self) -> f64 {
        let (weights, constant) = self.level_weights(0.0);
        constant + dot(&weights, &self.parameters)
    }

    /// Weights of the parameters in the output at rest at the command `u`, and its constant part.
    pub(super) fn level_weights(&self, u: f64) -> (Vec<f64>, f64) {
        let last = self.step_map.nrows() - 1;
        let columns = self.step_map.ncols();
        let weights = (0..columns)
            .map(|k| {
                let split: f64 = self.split_map.col_as_slice(k).iter().sum();
                let offset = f64::from(u8::from(k + 1 == columns));
                self.step_map[(last, k)] * (u - self.centre.0) - split * self.centre.1 + offset
            })
            .collect();
        (weights, self.centre.2)
    }
}
