//! A model against a record that it has not seen.

use serde::{Deserialize, Serialize};

use crate::error::Error;
use crate::model::Model;
use crate::record::Record;

/// Relative difference of sample periods that still counts as the same: clocks of two recordings
/// of one rig agree far better, and a different rate differs far more.
const PERIOD_TOLERANCE: f64 = 1e-6;

/// How well a model predicts a record, by simulation from the input alone.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Validation {
    /// 100 (1 - |y - ŷ| / |y - mean y|) over the samples used.
    pub fit_percent: f64,
    /// Root mean square of y - ŷ.
    pub rmse: f64,
    /// Mean of y - ŷ.
    pub bias: f64,
    /// Samples with an output and a full history of input.
    pub samples_used: usize,
}

impl Validation {
    /// Simulates `model` on every run of `record`.
    ///
    /// # Errors
    /// The record has another sample period, or no sample with enough history.
    pub fn of(model: &Model, record: &Record) -> Result<Self, Error> {
        let (expected, found) = (model.sample_period_s, record.sample_period_s());
        if ((found - expected) / expected).abs() > PERIOD_TOLERANCE {
            return Err(Error::PeriodMismatch { expected, found });
        }
        let pairs = record.runs().iter().flat_map(|run| {
            let simulated = model.simulate(run);
            run.output()
                .iter()
                .copied()
                .zip(simulated)
                .collect::<Vec<_>>()
        });
        Self::of_pairs(pairs).ok_or(Error::NoHistory {
            history: model.structure.settling_samples,
        })
    }

    /// Compares pairs of measured and predicted output; pairs with a NaN do not count. `None` when
    /// no pair is left.
    pub fn of_pairs(pairs: impl IntoIterator<Item = (f64, f64)>) -> Option<Self> {
        let pairs: Vec<(f64, f64)> = pairs
            .into_iter()
            .filter(|(y, predicted)| !(y - predicted).is_nan())
            .collect();
        if pairs.is_empty() {
            return None;
        }
        let count = pairs.len() as f64;
        let mean = pairs.iter().map(|(y, _)| y).sum::<f64>() / count;
        let bias = pairs
            .iter()
            .map(|(y, predicted)| y - predicted)
            .sum::<f64>()
            / count;
        let error = pairs
            .iter()
            .map(|(y, predicted)| (y - predicted).powi(2))
            .sum::<f64>();
        let spread = pairs.iter().map(|(y, _)| (y - mean).powi(2)).sum::<f64>();
        Some(Self {
            fit_percent: fit_percent(error, spread),
            rmse: (error / count).sqrt(),
            bias,
            samples_used: pairs.len(),
        })
    }
}

/// 100 (1 - sqrt(error/spread)) from two sums of squares. An output that does not move leaves
/// nothing to explain: 100 when it is met exactly, 0 when it is not.
pub(crate) fn fit_percent(error: f64, spread: f64) -> f64 {
    match (error > 0.0, spread > 0.0) {
        (_, true) => 100.0 * (1.0 - (error / spread).sqrt()),
        (false, false) => 100.0,
        (true, false) => 0.0,
    }
}
