//! The identified model: everything that is known about the servo after one identification.
//!
//! [`Model`] is plain data. It serialises to the schema-2 JSON document described field by field
//! below and back; every number in it is finite. Angles have the record's units, times are in
//! seconds, frequencies in rad/s.

use faer::Mat;
use serde::{Deserialize, Serialize};

use crate::data::{Run, Timing};
use crate::error::Error;
use crate::estimation::{FsfBasis, Noise};
use crate::numerics::causal_filter;
use crate::options::{LONGEST_SETTLING_BY_HAND, MAX_NOISE_ORDER};
use crate::results::advice::Advice;
use crate::results::band_estimate::BandEstimate;
use crate::results::frequency_response::{FrequencyBounds, FrequencyResponse};
use crate::results::metrics::measured::Measured;
use crate::results::metrics::{Metrics, Withheld};
use crate::results::residuals::Residuals;
use crate::results::step_response::{StepResponse, is_zero};
use crate::results::usable_numbers::{LARGEST, is_sized, is_usable};
use crate::results::validity::{Bounds, Reason};
use crate::thresholds::POOR_PREDICTION_PERCENT;

/// Version of the JSON document.
pub const MODEL_SCHEMA: u32 = 2;

/// Sample periods of a model that was read from elsewhere \[s\]: from a thousandth of what any
/// converter does to decades.
const PERIODS_S: std::ops::RangeInclusive<f64> = 1e-9..=1e9;

/// Who chose the structure.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum SelectedBy {
    /// The measured procedure.
    Auto,
    /// The measured procedure, with the frequencies of [`Frequencies::Narrow`](crate::Frequencies::Narrow).
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
    /// Version of this document, [`MODEL_SCHEMA`].
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
    /// The uncertainty of θ, where bounds hold.
    #[serde(flatten)]
    pub bounds: Bounds<ParameterBounds>,
    /// c of y = G u + c + v.
    pub offset: f64,
    /// What the offset of each run of the record is above c, their mean \[output\]; empty where the runs do not differ beyond chance.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub run_offsets: Vec<f64>,
    /// The slope of the drift of each run, about the middle of the run \[output/s\]; empty where none was found.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub run_slopes: Vec<f64>,
    /// D(z) and σ of v = ε/D(z).
    pub noise: Noise,
    /// Whether nothing was found that makes the response one of this motion alone. The bounds of a servo
    /// that is not linear are those of the linear description that fits this reference best.
    pub linear: bool,
    /// Response to a unit step.
    pub step: StepResponse,
    /// Frequency response.
    pub frequency: FrequencyResponse,
    /// How it was estimated, where it has bounds [in a band](Model::band) alone.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub band_estimate: Option<BandEstimate>,
    /// Gain, delay, rise time and the like.
    pub metrics: Metrics,
    /// How well the model reproduces its record.
    pub fit: Fit,
    /// Tests of the residuals.
    pub residuals: Residuals,
    /// Iterations of generalised least squares.
    pub iterations: usize,
    /// Whether the iterations came to rest.
    pub converged: bool,
    /// The outputs at which the servo stops within the range of its commands \[output\], one or two; empty where it does nowhere.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub stops: Vec<f64>,
    /// Findings, and what to do about them.
    pub advice: Vec<Advice>,
}

/// The uncertainty of the parameters.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ParameterBounds {
    /// Confidence level of all bounds of the model.
    pub level: f64,
    /// Covariance of θ, n x n.
    pub covariance: Vec<Vec<f64>>,
}

impl ParameterBounds {
    pub(crate) fn covariance_matrix(&self) -> Mat<f64> {
        let n = self.covariance.len();
        Mat::from_fn(n, n, |i, j| self.covariance[i][j])
    }
}

impl Model {
    /// Whether the end of its response may be how the servo answers the steps that follow, which passes for a response that goes on where a servo is not
    /// linear.
    #[must_use]
    pub fn may_answer_later_steps(&self) -> bool {
        !self.linear && self.step.bounds.withdrawn() == Some(Reason::ResponseNotOver)
    }

    /// Whether the parts of a document fit together: lengths, and numbers that can be computed with
    /// (up to 1e75). A model that was identified always does; one that was read from elsewhere has to
    /// be asked.
    #[must_use]
    pub fn is_consistent(&self) -> bool {
        let n = self.structure.frequencies;
        let settling = self.structure.settling_samples;
        let covariance = self.bounds.valid().is_none_or(|bounds| {
            bounds.covariance.len() == n && bounds.covariance.iter().all(|row| is_sized(row, n))
        });
        settling <= LONGEST_SETTLING_BY_HAND
            && self.basis().is_ok()
            && self.is_of_one_validity()
            && PERIODS_S.contains(&self.sample_period_s)
            && (0.0..=*PERIODS_S.end()).contains(&self.sample_phase_s)
            && is_usable(&self.offset)
            && self.run_offsets.iter().all(is_usable)
            && self.run_slopes.iter().all(is_usable)
            && is_sized(&self.theta, n)
            && covariance
            && self.structure.noise_order <= MAX_NOISE_ORDER
            && is_sized(&self.noise.ar, self.structure.noise_order)
            && (0.0..=LARGEST).contains(&self.noise.sigma)
            && self.step.is_consistent(settling)
            && self.frequency.is_consistent()
            && (self.band_estimate.as_ref()).is_none_or(BandEstimate::is_consistent)
            && self.metrics.is_consistent()
    }

    /// Whether all parts have bounds of one level, or none for one reason; or bounds within a band that is all that the input excites.
    fn is_of_one_validity(&self) -> bool {
        let level = self.level();
        let frequency = self.frequency.bounds.as_ref().map(|bounds| bounds.level);
        let is_known = match level {
            Bounds::Withdrawn(Reason::InputUnexcited) => frequency.valid().is_some(),
            _ => false,
        };
        self.step.bounds.as_ref().map(|bounds| bounds.level) == level
            && (frequency == level || is_known)
            && self.metrics.bounds.map(|bounds| bounds.level) == frequency
    }

    /// The bounds of the frequency response, where it alone has some: the input excites a band, and all of [`Model::frequency`] is in it. Step response and
    /// parameters are then a picture of the record, and not those of this response.
    #[must_use]
    pub fn band(&self) -> Option<&FrequencyBounds> {
        self.level().withdrawn().and(self.frequency.bounds.valid())
    }

    /// The ends of that band \[Hz\].
    #[must_use]
    pub fn band_hz(&self) -> Option<[f64; 2]> {
        self.band()?;
        let omegas = &self.frequency.omega_rad_s;
        let ends = [*omegas.first()?, *omegas.last()?];
        Some(ends.map(|omega| omega / std::f64::consts::TAU))
    }

    /// The level of the bounds, where they hold.
    #[must_use]
    pub fn level(&self) -> Bounds<f64> {
        self.bounds.as_ref().map(|bounds| bounds.level)
    }

    /// Takes all bounds away.
    pub(crate) fn withdraw(&mut self, reason: Reason) {
        self.bounds = Bounds::Withdrawn(reason);
        self.step.bounds = Bounds::Withdrawn(reason);
        self.frequency.bounds = Bounds::Withdrawn(reason);
        self.band_estimate = None;
        self.metrics = self.metrics.withdrawn(reason);
    }

    /// The same without bounds, for what is computed of it where theirs would not hold.
    #[must_use]
    pub fn withdrawn_for(mut self, reason: Reason) -> Self {
        self.withdraw(reason);
        self
    }

    /// Takes all bounds away, because the servo runs into stops at these outputs: its times are those of the stops, too.
    pub fn withdraw_at_stops(&mut self, stops: Vec<f64>) {
        self.withdraw(Reason::TravelEnd);
        self.stops = stops;
    }

    /// Takes all bounds away, and all metrics but the gain, where the times of the record turn out to be others than they were taken for.
    /// A model without times keeps its own reason.
    pub fn withdraw_times(&mut self, reason: Reason) {
        if self.metrics.withheld == Some(Withheld::TimeFault) {
            return;
        }
        self.withdraw(reason);
        let (gain, bounds) = (self.metrics.dc_gain, self.metrics.bounds);
        self.metrics = Metrics::withheld(gain, Withheld::TimeFault, bounds);
    }

    /// The same with bounds that allow for output that was recorded up to `seconds` earlier or later than it is taken for: of both
    /// responses, of the times from the edge, and of the frequency of a phase.
    #[must_use]
    pub fn with_delay_error(mut self, seconds: f64) -> Self {
        if seconds == 0.0 {
            return self;
        }
        let response = self.response_of_phase();
        self.metrics = self.metrics.with_delay_error(seconds, &response);
        if let Bounds::Valid(bounds) = &mut self.step.bounds {
            bounds.allow_for_delay_error(seconds / self.sample_period_s);
        }
        let omegas = &self.frequency.omega_rad_s;
        let bounds = self.frequency.bounds;
        self.frequency.bounds = bounds.map(|bounds| bounds.with_delay_error(omegas, seconds));
        self
    }

    /// The same with bounds of the frequency response that allow for a command that went on between the samples, and was not held at each. A hold makes a sine
    /// smaller by sin(x)/x with x = ωT/2, and linear pieces by the square of that: what the model takes for the servo's may be the hold's, by up to as much. Its delay
    /// is for [`Self::with_delay_error`].
    #[must_use]
    pub fn with_command_between_samples(mut self) -> Self {
        let response = &self.frequency;
        let points = response
            .omega_rad_s
            .iter()
            .zip(response.re.iter().zip(&response.im));
        let extra = points.map(|(omega, (re, im))| {
            let half = 0.5 * omega * self.sample_period_s;
            re.hypot(*im) * (half / half.sin() - 1.0).abs()
        });
        let extra: Vec<f64> = extra.collect();
        let bounds = self.frequency.bounds;
        self.frequency.bounds = bounds.map(|bounds| bounds.with_further_bias(&extra));
        self
    }

    /// By how much the output may have been recorded earlier or later than it is taken for, where bounds hold that allow for it \[s\].
    pub(crate) fn delay_error_s(&self) -> f64 {
        self.frequency
            .bounds
            .valid()
            .map_or(0.0, |bounds| bounds.delay_error_s)
    }

    /// The metrics with intervals that do not allow for that.
    pub(crate) fn metrics_at_stated_delay(&self) -> Metrics {
        match self.delay_error_s() {
            0.0 => self.metrics,
            seconds => {
                let response = self.response_of_phase();
                self.metrics.without_delay_error(seconds, &response)
            }
        }
    }

    /// A response that says how fast the phase falls: without the servo's own, that of its samples says it as well.
    fn response_of_phase(&self) -> std::borrow::Cow<'_, FrequencyResponse> {
        match self.servo_response(&self.frequency.omega_rad_s) {
            Ok(response) => std::borrow::Cow::Owned(response),
            Err(_) => std::borrow::Cow::Borrowed(&self.frequency),
        }
    }

    /// All that metrics are read from, where bounds hold.
    ///
    /// # Errors
    /// The structure of a hand-made document does not describe a filter bank.
    pub(crate) fn measured(&self) -> Result<Bounds<Measured<'_>>, Error> {
        let basis = self.basis()?;
        let (step, frequency) = (self.step.bounds.as_ref(), self.frequency.bounds.as_ref());
        let known = self.bounds.as_ref().zip(step.zip(frequency));
        let measured = |(parameters, (step_bounds, frequency_bounds))| Measured {
            basis,
            theta: &self.theta,
            covariance: ParameterBounds::covariance_matrix(parameters),
            step: &self.step.value,
            step_bounds,
            omega_rad_s: &self.frequency.omega_rad_s,
            frequency_bounds,
            timing: self.timing(),
        };
        Ok(known.map(measured))
    }

    /// The metrics, read off the responses again, where bounds hold.
    ///
    /// # Errors
    /// The structure of a hand-made document does not describe a filter bank.
    pub fn metrics_anew(&self) -> Result<Bounds<Metrics>, Error> {
        let bounds = self.metrics.bounds;
        Ok(self
            .measured()?
            .map(|measured| Metrics::new(&measured, bounds)))
    }

    /// When the samples of the model's responses are taken.
    #[must_use]
    pub fn timing(&self) -> Timing {
        Timing {
            sample_period_s: self.sample_period_s,
            sample_phase_s: self.sample_phase_s,
        }
    }

    /// Whether it predicts its record as well as noise lets it, or nearly so: where it has bounds, if in a band alone, its errors were tested as noise.
    #[must_use]
    pub fn predicts(&self) -> bool {
        let is_tested = self.frequency.bounds.valid().is_some();
        is_tested || self.fit.simulation_percent >= POOR_PREDICTION_PERCENT
    }

    /// The filter bank of the model.
    ///
    /// # Errors
    /// The structure of a hand-made document does not describe a filter bank.
    pub fn basis(&self) -> Result<FsfBasis, Error> {
        FsfBasis::new(self.structure.settling_samples, self.structure.frequencies)
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
        let pairs = run.output().iter().zip(&simulated);
        let error: Vec<f64> = pairs.map(|(y, simulated)| y - simulated).collect();
        let predicted = |(k, simulated): (usize, &f64)| simulated - self.noise_memory(&error, k);
        simulated.iter().enumerate().map(predicted).collect()
    }

    /// sum_i d_i x(k-i); NaN where a past value is missing.
    pub(crate) fn noise_memory(&self, values: &[f64], k: usize) -> f64 {
        let past = |(d, i): (&f64, usize)| k.checked_sub(i).map_or(f64::NAN, |k| d * values[k]);
        self.noise.ar.iter().zip(1..).map(past).sum()
    }
}
