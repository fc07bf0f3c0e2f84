//! A model against a record that it has not seen.

use serde::{Deserialize, Serialize};

use crate::data::{Record, Run};
use crate::error::Error;
use crate::results::model::Model;
use crate::thresholds::FROM_REST;

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
    /// Runs whose input before the first sample was not stated and is taken to have stood still,
    /// as their first samples show: these are then among the samples used.
    #[serde(default)]
    pub runs_from_rest: usize,
}

impl Validation {
    /// See [`Model::validate`].
    fn of(model: &Model, record: &Record) -> Result<Self, Error> {
        require_period(record, model.sample_period_s)?;
        let mut with_history = Vec::new();
        let mut from_rest = Vec::new();
        let mut runs_from_rest = 0;
        for run in record.runs() {
            let simulated = model.simulate(run);
            with_history.extend(run.output().iter().copied().zip(simulated));
            if run.input_at_rest().is_none()
                && let Some(beginning) = beginning_from_rest(model, run)
            {
                from_rest.extend(beginning);
                runs_from_rest += 1;
            }
        }
        let judged = Self::of_pairs(with_history.iter().copied()).ok_or(Error::NoHistory {
            history: model.structure.settling_samples,
        })?;
        let beginnings = Self::of_pairs(from_rest.iter().copied());
        if beginnings.is_none_or(|beginnings| beginnings.rmse > FROM_REST * judged.rmse) {
            return Ok(judged);
        }
        let all = Self::of_pairs(with_history.into_iter().chain(from_rest));
        Ok(all.map_or(judged, |all| Self {
            runs_from_rest,
            ..all
        }))
    }

    /// Compares pairs of measured and predicted output; pairs with a NaN do not count. `None` when
    /// no pair is left.
    #[must_use]
    pub fn of_pairs(pairs: impl IntoIterator<Item = (f64, f64)>) -> Option<Self> {
        let known = pairs
            .into_iter()
            .filter(|(y, predicted)| !(y - predicted).is_nan());
        let pairs: Vec<(f64, f64)> = known.collect();
        if pairs.is_empty() {
            return None;
        }
        let sum = |of: &dyn Fn(&(f64, f64)) -> f64| pairs.iter().map(of).sum::<f64>();
        let count = pairs.len() as f64;
        let mean = sum(&|(y, _)| *y) / count;
        let error = sum(&|(y, predicted)| (y - predicted).powi(2));
        Some(Self {
            fit_percent: fit_percent(error, sum(&|(y, _)| (y - mean).powi(2))),
            rmse: (error / count).sqrt(),
            bias: sum(&|(y, predicted)| y - predicted) / count,
            samples_used: pairs.len(),
            runs_from_rest: 0,
        })
    }
}

/// Requires that a record has the sample period `expected` \[s\].
fn require_period(record: &Record, expected: f64) -> Result<(), Error> {
    let found = record.sample_period_s();
    if ((found - expected) / expected).abs() > PERIOD_TOLERANCE {
        return Err(Error::PeriodMismatch { expected, found });
    }
    Ok(())
}

impl Model {
    /// Simulates every run of a record that the model has not seen and compares.
    ///
    /// The first N-1 samples of a run have no full history of input, unless the run states it. The servo is then
    /// taken to have stood still where the first sample finds it. If the model, so started, is about as near to
    /// these samples as to the ones with a history, they are judged as well; otherwise the runs do not begin at
    /// rest, and they are left out. The decision is one for the whole record.
    ///
    /// ```
    /// # use servoid_identification::{identify, Options, Record, Settling, Frequencies, NoiseOrder};
    /// # let u: Vec<f64> = (0..400).map(|k| f64::from(k * k / 35 % 2)).collect();
    /// # let y: Vec<f64> = u.iter().scan(0.0, |y, u| { *y += 0.3 * (u - *y); Some(*y) }).collect();
    /// let seen = Record::of_run(0.01, &u[..200], &y[..200])?;
    /// let unseen = Record::of_run(0.01, &u[200..], &y[200..])?;
    /// let options = Options { settling: Settling::Samples(31), ..Options::default() };
    /// let model = identify(&seen, &options)?;
    /// assert!(model.validate(&unseen)?.fit_percent > 99.0);
    /// # Ok::<(), servoid_identification::Error>(())
    /// ```
    ///
    /// # Errors
    /// The record has another sample period, or no sample with enough history.
    pub fn validate(&self, record: &Record) -> Result<Validation, Error> {
        Validation::of(self, record)
    }
}

/// The first N-1 samples of a run with the model's output for them when the servo had stood still
/// before where its first sample finds it. `None` when that sample is missing.
fn beginning_from_rest(model: &Model, run: &Run) -> Option<Vec<(f64, f64)>> {
    let count = (model.structure.settling_samples - 1).min(run.len());
    let beginning = run.part(0..count);
    let at_rest = command_before(&beginning, &model.step.value, model.offset)?;
    let simulated = model.simulate_input(beginning.input(), Some(at_rest));
    Some(beginning.output().iter().copied().zip(simulated).collect())
}

/// The command at which a linear servo with this step response and offset had stood still before a run whose first sample
/// it meets. `None` when that sample is missing, or no command does that.
pub(crate) fn command_before(run: &Run, step: &[f64], offset: f64) -> Option<f64> {
    let (at_once, gain) = (step.first()?, step.last()?);
    // At the first sample the response is that to one step from rest: y = c + G0 r + g_0 (u - r).
    let (input, output) = (run.input().first()?, run.output().first()?);
    let at_rest = (output - offset - at_once * input) / (gain - at_once);
    at_rest.is_finite().then_some(at_rest)
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{NoiseOrder, Options, Settling, identify};
    use rand::{RngExt, SeedableRng};

    /// Two lags of 5 samples behind random levels of 5 samples each, 200 samples of which are not
    /// recorded; a little noise. With one lag the first sample would determine the whole state.
    fn run(seed: u64, rest: bool, samples: usize) -> Run<'static> {
        let mut random = rand_chacha::ChaCha8Rng::seed_from_u64(seed);
        let before = 200;
        let mut input: Vec<f64> = Vec::new();
        while input.len() < before + samples {
            let level = random.random_range(-1.0..1.0);
            input.extend([level; 5]);
        }
        if rest {
            input[..before].fill(0.4);
        }
        let mut lags = [input[0]; 2];
        let output: Vec<f64> = input
            .iter()
            .map(|u| {
                lags[0] += (u - lags[0]) / 5.0;
                lags[1] += (lags[0] - lags[1]) / 5.0;
                2.0 * lags[1] + 0.3 + 0.005 * random.random_range(-1.0..1.0)
            })
            .collect();
        Run::new(
            input[before..before + samples].to_vec(),
            output[before..before + samples].to_vec(),
        )
        .unwrap()
    }

    #[test]
    fn runs_that_begin_at_rest_are_judged_from_their_first_sample_and_others_are_not() {
        let options = Options {
            settling: Settling::Samples(61),
            noise_order: NoiseOrder::Order(0),
            ..Options::default()
        };
        let seen = Record::new(0.01, vec![run(1, false, 900)]).unwrap();
        let model = identify(&seen, &options).unwrap();
        let at_rest = Record::new(0.01, vec![run(2, true, 300), run(3, true, 40)]).unwrap();
        let found = model.validate(&at_rest).unwrap();
        assert_eq!((found.samples_used, found.runs_from_rest), (340, 2));
        assert!(found.fit_percent > 98.0, "{found:?}");
        // In motion at the first sample: a constant past does not explain what follows.
        let moving = Record::new(0.01, vec![run(4, false, 300), run(5, false, 40)]).unwrap();
        let found = model.validate(&moving).unwrap();
        assert_eq!((found.samples_used, found.runs_from_rest), (240, 0));
        assert!(found.fit_percent > 98.0, "{found:?}");
        // Nothing of a run shorter than the history can be judged by itself.
        let short = Record::new(0.01, vec![run(6, true, 40)]).unwrap();
        assert!(model.validate(&short).is_err());
    }
}
