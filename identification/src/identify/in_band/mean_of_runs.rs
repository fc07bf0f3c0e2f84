//! The mean response of several runs, and how sure it is by how they differ.
//!
//! A smooth input determines the response in its band within each run, so each run has a response there. From run to run the servo changes, and noise moves
//! them as well: with R runs the mean has the covariance of both,
//!
//! ```text
//! sum_r d_r d_r' / (R (R - 1)),    d_r = G_r - mean of G
//! ```
//!
//! at R - 1 degrees of freedom, whatever it is that changes. Noise counts once more beside it, because what all runs share, as the prior's part, is not in how they differ.

use super::whole_response::WholeResponse;

/// Re G and Im G in turn.
pub(super) struct MeanOfRuns {
    pub(super) values: Vec<f64>,
    /// Of each run.
    distances: Vec<Vec<f64>>,
}

impl MeanOfRuns {
    /// At `omegas` \[rad/sample\]; `None` of fewer than two `runs`.
    pub(super) fn of(runs: &[WholeResponse], omegas: &[f64]) -> Option<Self> {
        if runs.len() < 2 {
            return None;
        }
        let all: Vec<Vec<f64>> = runs.iter().map(|run| run.values(omegas)).collect();
        let mean = |i: usize| all.iter().map(|run| run[i]).sum::<f64>() / all.len() as f64;
        let values: Vec<f64> = (0..2 * omegas.len()).map(mean).collect();
        let distance = |run: &Vec<f64>| run.iter().zip(&values).map(|(g, mean)| g - mean).collect();
        Some(Self {
            distances: all.iter().map(distance).collect(),
            values,
        })
    }

    /// Of two entries of the mean.
    pub(super) fn covariance(&self, i: usize, k: usize) -> f64 {
        let products = self.distances.iter().map(|run| run[i] * run[k]);
        products.sum::<f64>() / (self.distances.len() as f64 * self.degrees())
    }

    pub(super) fn degrees(&self) -> f64 {
        self.distances.len() as f64 - 1.0
    }
}
