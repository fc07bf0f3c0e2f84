//! How the response within a band was estimated, for whoever goes back to the record with it.

use serde::{Deserialize, Serialize};

use crate::options::{LONGEST_SETTLING_BY_HAND, MAX_NOISE_ORDER};
use crate::results::usable_numbers::{LARGEST, is_sized};

/// The estimate behind the [frequency response in a band](crate::results::Model::band): all lags up to N by generalised least squares under a prior, each lag
/// independent with mean 0.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BandEstimate {
    /// N \[samples\].
    pub settling_samples: usize,
    /// d_1..d_d of the noise filter D.
    pub ar: Vec<f64>,
    /// Variance of ε over that of the prior of a lag \[input²\].
    pub precision: f64,
    /// By how much the standard deviations of the response are wider than those of even noise, where they are most: noise that is not even, errors of the
    /// commands and few degrees of freedom are in it.
    pub beyond_even_noise: f64,
    /// The slopes of the runs that were taken out of the output \[output per sample\]; empty where none were.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub slopes: Vec<f64>,
}

impl BandEstimate {
    /// The same beside the slope of one run alone, from 0; of all runs without one.
    pub(crate) fn of_run(&self, run: Option<usize>) -> Self {
        let slope = |run: usize| self.slopes.get(run).copied().into_iter().collect();
        Self {
            slopes: run.map_or_else(|| self.slopes.clone(), slope),
            ..self.clone()
        }
    }

    /// Whether its parts fit together, with numbers that can be computed with.
    pub(super) fn is_consistent(&self) -> bool {
        let is_sized_all = |values: &[f64]| is_sized(values, values.len());
        let positive = f64::MIN_POSITIVE..=LARGEST;
        (1..=LONGEST_SETTLING_BY_HAND).contains(&self.settling_samples)
            && self.ar.len() <= MAX_NOISE_ORDER
            && is_sized_all(&self.ar)
            && is_sized_all(&self.slopes)
            && positive.contains(&self.precision)
            && (1.0..=LARGEST).contains(&self.beyond_even_noise)
    }
}
