//! The identified model: everything that is known about the servo after one identification.
//!
//! [`Model`] is plain data. It serialises to the schema-1 JSON document described field by field
//! below and back; every number in it is finite. Angles have the record's units, times are in
//! seconds, frequencies in rad/s.

use serde::{Deserialize, Serialize};

use crate::data::record::{Record, Run};
use crate::diagnostics::advice::{Advice, NOT_LINEAR, WITHDRAWING};
use crate::diagnostics::residual_tests::Residuals;
use crate::error::Error;
use crate::estimation::fsf_basis::FsfBasis;
use crate::estimation::noise_model::Noise;
use crate::numerics::convolution::causal_filter;
use crate::options::{LEVELS, LONGEST_SETTLING_BY_HAND, MAX_NOISE_ORDER};
use crate::results::frequency_response::FrequencyResponse;
use crate::results::metrics::Metrics;
use crate::results::step_response::StepResponse;
use crate::results::validation::Validation;

/// Version of the JSON document.
pub const SCHEMA: u32 = 1;

/// The largest number in a model that was read from elsewhere: products of four such numbers are
/// still numbers.
pub(crate) const LARGEST: f64 = 1e75;

/// Sample periods of a model that was read from elsewhere \[s\]: from a thousandth of what any
/// converter does to decades.
const PERIODS_S: std::ops::RangeInclusive<f64> = 1e-9..=1e9;

/// Who chose the structure.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum SelectedBy {
    /// The measured procedure.
    Auto,
    /// The measured procedure, with the narrow number of frequencies.
    Narrow,
    /// The caller fixed the settling time or the frequencies.
    User,
}

/// N, n and d.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Structure {
    /// N \[samples\].
    pub settling_samples: usize,
    /// n, odd.
    pub frequencies: usize,
    /// d.
    pub noise_order: usize,
    /// Who chose.
    pub selected_by: SelectedBy,
}

/// How well the model reproduces the record it was identified from.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Fit {
    /// 100 (1 - |y - ŷ| / |y - mean y|) with ŷ simulated from the input alone.
    pub simulation_percent: f64,
    /// The same with ŷ predicted one step ahead from the input and the past output.
    pub one_step_percent: f64,
    /// Root mean square of the simulation error.
    pub rmse: f64,
    /// Rows with a full history.
    pub samples_used: usize,
    /// Samples that lack the input or the output.
    pub samples_missing: usize,
}

/// An identified servo.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Model {
    /// Version of this document, [`SCHEMA`].
    pub schema: u32,
    /// Time between samples \[s\].
    pub sample_period_s: f64,
    /// Time from an edge of the input to the sample that belongs to it \[s\]: element m of the step
    /// response is the servo m Ts plus this after the edge.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub sample_phase_s: f64,
    /// N, n and d.
    pub structure: Structure,
    /// θ = \[G0, Re G1, Im G1, ...\], n values: the frequency response at l·2π/(N Ts) rad/s, with
    /// the physical sign (a lag has negative imaginary part).
    pub theta: Vec<f64>,
    /// Covariance of θ, n x n.
    pub covariance: Vec<Vec<f64>>,
    /// c of y = G u + c + v.
    pub offset: f64,
    /// D(z) and σ of v = ε/D(z).
    pub noise: Noise,
    /// Response to a unit step, with bounds.
    pub step: StepResponse,
    /// Frequency response, with bounds.
    pub frequency: FrequencyResponse,
    /// Gain, delay, rise time and the like.
    pub metrics: Metrics,
    /// How well the model reproduces its record.
    pub fit: Fit,
    /// Tests of what is left over.
    pub residuals: Residuals,
    /// Iterations of generalised least squares.
    pub iterations: usize,
    /// Whether the iterations came to rest.
    pub converged: bool,
    /// What to know and what to do about it; never a replacement for the numbers.
    pub advice: Vec<Advice>,
}

/// For serde, which hands over a reference.
#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde's signature")]
fn is_zero(value: &f64) -> bool {
    *value == 0.0
}

impl Model {
    /// Whether the parts of a document fit together: lengths, and numbers that can be computed with
    /// (up to 1e75). A model that was identified always does; one that was read from elsewhere has to
    /// be asked.
    #[must_use]
    pub fn is_consistent(&self) -> bool {
        let n = self.structure.frequencies;
        let settling = self.structure.settling_samples;
        let usable = |value: &f64| value.abs() <= LARGEST;
        let finite = |values: &[f64]| values.iter().all(usable);
        let sized = |values: &[f64], length: usize| values.len() == length && finite(values);
        let (step, f) = (&self.step, &self.frequency);
        let points = f.omega_rad_s.len();
        let levels = [step.pointwise.level, step.simultaneous.level];
        settling <= LONGEST_SETTLING_BY_HAND
            && self.basis().is_ok()
            && levels.iter().all(|level| LEVELS.contains(level))
            && PERIODS_S.contains(&self.sample_period_s)
            && (0.0..=*PERIODS_S.end()).contains(&self.sample_phase_s)
            && usable(&self.offset)
            && (0.0..=LARGEST).contains(&step.truncation_bias)
            && (0.0..=LARGEST).contains(&step.rounding_bias)
            && usable(&step.simultaneous.critical_value)
            && sized(&self.theta, n)
            && self.covariance.len() == n
            && self.covariance.iter().all(|row| sized(row, n))
            && self.structure.noise_order <= MAX_NOISE_ORDER
            && sized(&self.noise.ar, self.structure.noise_order)
            && (0.0..=LARGEST).contains(&self.noise.sigma)
            && [&step.time_s, &step.value, &step.sd]
                .into_iter()
                .chain([&step.pointwise.lower, &step.pointwise.upper])
                .chain([&step.simultaneous.lower, &step.simultaneous.upper])
                .all(|values| sized(values, settling))
            && [&f.omega_rad_s, &f.re, &f.im, &f.magnitude_db, &f.phase_deg]
                .into_iter()
                .chain([&f.magnitude_db_lower, &f.magnitude_db_upper])
                .chain([&f.phase_deg_lower, &f.phase_deg_upper])
                .all(|values| sized(values, points))
            && (f.bias.is_empty() || sized(&f.bias, points))
            && f.bias.iter().all(|bias| *bias >= 0.0)
    }

    /// The filter bank of the model.
    ///
    /// # Errors
    /// The structure of a hand-made document does not describe a filter bank.
    pub fn basis(&self) -> Result<FsfBasis, Error> {
        FsfBasis::new(self.structure.settling_samples, self.structure.frequencies)
    }

    /// Whether the bounds have earned their level: not when the errors turned out not to be noise (see
    /// [`crate::diagnostics::misfit`]), nor when the input does not tell all of the response ([`crate::estimation::excitation`]), nor when
    /// a rounding that no bound contains is larger than the noise ([`crate::data::quantisation`]). The advice has the reason.
    #[must_use]
    pub fn bounds_hold(&self) -> bool {
        self.without_level_because().is_none()
    }

    /// Why the bounds have no level, in a few words for beside a number; `None` while they hold. The advice says
    /// it in full.
    #[must_use]
    pub fn without_level_because(&self) -> Option<&'static str> {
        WITHDRAWING
            .iter()
            .find(|(check, _)| self.advice.iter().any(|advice| advice.check == *check))
            .map(|(_, reason)| *reason)
    }

    /// Whether the bounds are only those of the linear description that fits the reference best,
    /// because the servo is not linear (see [`crate::diagnostics::linearity`]).
    #[must_use]
    pub fn is_best_linear_description(&self) -> bool {
        self.advice.iter().any(|advice| advice.check == NOT_LINEAR)
    }

    /// The impulse response T θ, N samples.
    #[must_use]
    pub fn impulse_response(&self) -> Vec<f64> {
        let mut previous = 0.0;
        self.step
            .value
            .iter()
            .map(|&value| value - std::mem::replace(&mut previous, value))
            .collect()
    }

    /// The output that the model gives for the input of `run`, one value per sample. NaN where
    /// the history of N input samples is not complete; with [`Run::with_input_at_rest`] it is
    /// complete from the first sample on.
    #[must_use]
    pub fn simulate(&self, run: &Run) -> Vec<f64> {
        self.simulate_input(run.input(), run.input_at_rest())
    }

    /// [`Model::simulate`] for an input alone.
    #[must_use]
    pub fn simulate_input(&self, input: &[f64], at_rest: Option<f64>) -> Vec<f64> {
        causal_filter(&self.impulse_response(), input, at_rest)
            .into_iter()
            .map(|y| y + self.offset)
            .collect()
    }

    /// The output predicted one step ahead from the input and the measured past output:
    /// ŷ(k) = y_sim(k) - sum_i d_i (y - y_sim)(k-i). NaN where a past value is missing.
    #[must_use]
    pub fn predict(&self, run: &Run) -> Vec<f64> {
        let simulated = self.simulate(run);
        let error: Vec<f64> = run
            .output()
            .iter()
            .zip(&simulated)
            .map(|(y, simulated)| y - simulated)
            .collect();
        simulated
            .iter()
            .enumerate()
            .map(|(k, simulated)| {
                let past =
                    self.noise
                        .ar
                        .iter()
                        .enumerate()
                        .map(|(i, d)| match k.checked_sub(i + 1) {
                            Some(before) => d * error[before],
                            None => f64::NAN,
                        });
                simulated - past.sum::<f64>()
            })
            .collect()
    }

    /// Simulates every run of a record that the model has not seen and compares.
    ///
    /// ```
    /// # use servoid_identification::{identify, Options, Record, Settling, Frequencies, NoiseOrder};
    /// # let u: Vec<f64> = (0..400).map(|k| f64::from(k * k / 35 % 2)).collect();
    /// # let y: Vec<f64> = u.iter().scan(0.0, |y, u| { *y += 0.3 * (u - *y); Some(*y) }).collect();
    /// let seen = Record::from_slices(0.01, &u[..200], &y[..200])?;
    /// let unseen = Record::from_slices(0.01, &u[200..], &y[200..])?;
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
