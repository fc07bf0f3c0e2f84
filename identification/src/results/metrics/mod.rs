//! The numbers that people ask for, read off the responses, each with its interval.
//!
//! The figures are those of the servo, not of its samples: times count from the edge of the command
//! (see [`crate::data::timing`]), crossings between samples are interpolated by cubics, and magnitude and
//! phase are freed of the hold of the samples.
//!
//! # Intervals
//!
//! * **Gain and phase**: the bound of the response itself (Student's, Fieller's).
//! * **Crossing times, bandwidth, -90 degrees**: the places at which the response may be passing its
//!   level, Student's t included (Fieller 1954). Where the response does not surely rise through the
//!   level, so that several samples may be the one, quantiles over seeded draws of the response from
//!   the covariance of its fit; they are the same where both can be had. What interpolation between
//!   samples may be wrong by is added to the crossing times. Where single samples are known to no better
//!   than a twentieth of the final value, draws are as rough as the estimate that they start from, and miss;
//!   a bracket joins them: from where a sample may be beyond the level to where one surely is.
//! * **Overshoot**, which cannot be negative and is a maximum over noisy samples, and **settling**,
//!   which jumps when a peak enters its band, are not smooth: draws miss the truth there. A bracket
//!   takes their place. With z_1 the critical value of one sample and z_k that of all k samples that
//!   can be the one sought (Bonferroni), v_m the response over its edge and s_m its standard
//!   deviation,
//!
//! ```text
//! overshoot  from max(0, max_m (v_m - z_k s_m))          to max(0, max_m (v_m + z_1 s_m))
//! settling   from the last m with v_m - z_k s_m > 0      to one after the last with v_m + z_1 s_m > 0
//! ```
//!
//!   The upper ends need no more than z_1, because only one sample can make them wrong: the true
//!   peak, and the last sample truly outside. Where the response closes in on its final value over
//!   the whole bracket, only one crossing can be the last, and its interval is the sharper answer.
//!
//! The bounds of what left-out frequencies may hide, and of what the steps of a sensor add, are in all of them.

mod aliasing;
mod bands;
mod brackets;
mod draws;
mod figures;
mod interpolation;
mod inversion;
mod shape;
mod spread;

use faer::Mat;
use serde::{Deserialize, Serialize};

use crate::data::timing::Timing;
use crate::error::Error;
use crate::estimation::fsf_basis::FsfBasis;
use crate::results::frequency_response::FrequencyResponse;
use crate::results::model::Model;
use crate::results::step_response::StepResponse;

use figures::Figures;
use spread::Spread;

/// A value with its bounds; `None` where the responses do not determine it.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Interval {
    /// Best estimate.
    pub value: Option<f64>,
    /// Lower bound.
    pub lower: Option<f64>,
    /// Upper bound.
    pub upper: Option<f64>,
}

impl Interval {
    /// An interval; numbers that are not finite become `None`.
    #[must_use]
    pub fn new(value: f64, lower: f64, upper: f64) -> Self {
        let finite = |x: f64| x.is_finite().then_some(x);
        Self {
            value: finite(value),
            lower: finite(lower),
            upper: finite(upper),
        }
    }

    /// The same interval in another unit: a rising function of value and bounds.
    pub(crate) fn map(self, of: impl Fn(f64) -> f64) -> Self {
        Self {
            value: self.value.map(&of),
            lower: self.lower.map(&of),
            upper: self.upper.map(&of),
        }
    }

    /// Whether `x` is not excluded: a missing bound excludes nothing.
    ///
    /// ```
    /// use servoid_identification::metrics::Interval;
    /// assert!(Interval::new(1.0, 0.9, f64::INFINITY).contains(7.0));
    /// assert!(!Interval::new(1.0, 0.9, 1.1).contains(0.8));
    /// ```
    #[must_use]
    pub fn contains(&self, x: f64) -> bool {
        self.lower.is_none_or(|lower| lower <= x) && self.upper.is_none_or(|upper| x <= upper)
    }
}

/// Figures of the responses, with intervals at the level of the model.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Metrics {
    /// Final value of the step response \[output per input\].
    pub dc_gain: Interval,
    /// From 10 to 90 % of the final value \[s\].
    pub rise_time_s: Interval,
    /// From the edge until the response stays within 2 % of the final value \[s\]. Without an upper
    /// bound the response may settle later than the model can see.
    pub settling_time_s: Interval,
    /// Highest point above the final value \[% of it\].
    pub overshoot_percent: Interval,
    /// From the edge until 5 % of the final value \[s\]: the last such crossing before half of it,
    /// so that noise on the flat part before does not count.
    pub delay_s: Interval,
    /// From the edge until half of the final value \[s\].
    #[serde(default)]
    pub t50_s: Interval,
    /// Where the magnitude of the servo has fallen by 3 dB from its value at rest \[rad/s\].
    pub bandwidth_rad_s: Interval,
    /// Where the phase of the servo reaches -90 degrees \[rad/s\].
    #[serde(default)]
    pub phase_minus_90_rad_s: Interval,
}

/// The phase of the servo at one frequency.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct PhaseAt {
    /// Frequency \[rad/s\].
    pub omega_rad_s: f64,
    /// Phase \[degrees\]; a lag is negative.
    pub phase_deg: Interval,
}

/// A response and what is known about it: all that the figures are read from.
pub(crate) struct Measured<'a> {
    pub(crate) basis: &'a FsfBasis,
    pub(crate) theta: &'a [f64],
    /// Covariance of θ.
    pub(crate) covariance: &'a Mat<f64>,
    pub(crate) step: &'a StepResponse,
    pub(crate) frequency: &'a FrequencyResponse,
    pub(crate) timing: Timing,
}

impl Metrics {
    /// Reads the figures off.
    pub(crate) fn new(measured: &Measured<'_>) -> Self {
        let step = measured.step;
        let last = step.value.len() - 1;
        let dc_gain = Interval::new(
            step.value[last],
            step.pointwise.lower[last],
            step.pointwise.upper[last],
        );
        // Everything else is relative to a gain, and there is none if it may be zero.
        if dc_gain.contains(0.0) {
            return Self::gain_alone(dc_gain);
        }
        let spread = Spread::new(measured);
        let figures = Figures::new(measured, &spread);
        let rise = figures.rise();
        let [bandwidth_rad_s, phase_minus_90_rad_s] =
            bands::bandwidth_and_quarter_turn(measured, spread.widest());
        // No response comes before its edge, whatever a wide interval says.
        let since_edge = |samples: f64| measured.timing.seconds(samples).max(0.0);
        Self {
            dc_gain,
            rise_time_s: rise
                .rise
                .map(|samples| (samples * measured.timing.sample_period_s).max(0.0)),
            settling_time_s: figures.settling().map(since_edge),
            overshoot_percent: figures.overshoot().map(|share| 100.0 * share),
            delay_s: rise.delay.map(since_edge),
            t50_s: rise.half.map(since_edge),
            bandwidth_rad_s,
            phase_minus_90_rad_s,
        }
    }

    /// Nothing but the gain is determined.
    pub(crate) fn gain_alone(dc_gain: Interval) -> Self {
        Self {
            dc_gain,
            rise_time_s: Interval::default(),
            settling_time_s: Interval::default(),
            overshoot_percent: Interval::default(),
            delay_s: Interval::default(),
            t50_s: Interval::default(),
            bandwidth_rad_s: Interval::default(),
            phase_minus_90_rad_s: Interval::default(),
        }
    }

    /// The figures of a model, as [`crate::identify()`] has already put them into it.
    ///
    /// # Errors
    /// The structure of a hand-made document does not describe a filter bank.
    pub fn of_model(model: &Model) -> Result<Self, Error> {
        let (basis, covariance) = (model.basis()?, covariance_of(model));
        Ok(Self::new(&Measured {
            basis: &basis,
            theta: &model.theta,
            covariance: &covariance,
            step: &model.step,
            frequency: &model.frequency,
            timing: model.timing(),
        }))
    }
}

pub(crate) fn covariance_of(model: &Model) -> Mat<f64> {
    let n = model.theta.len();
    Mat::from_fn(n, n, |i, j| model.covariance[i][j])
}

impl Model {
    /// When the samples of the model's responses are taken.
    #[must_use]
    pub fn timing(&self) -> Timing {
        Timing {
            sample_period_s: self.sample_period_s,
            sample_phase_s: self.sample_phase_s,
        }
    }

    /// The frequency response of the servo itself, at any frequencies \[rad/s\] up to half the rate
    /// of sampling, with pointwise bounds at the level of the model: [`Model::frequency`] is what
    /// the samples show, and this is freed of their hold and phase (see [`crate::data::timing`]).
    ///
    /// # Errors
    /// The structure of a hand-made document does not describe a filter bank.
    pub fn servo_response(&self, omega_rad_s: &[f64]) -> Result<FrequencyResponse, Error> {
        let (basis, covariance) = (self.basis()?, covariance_of(self));
        Ok(bands::servo_response(
            &Measured {
                basis: &basis,
                theta: &self.theta,
                covariance: &covariance,
                step: &self.step,
                frequency: &self.frequency,
                timing: self.timing(),
            },
            omega_rad_s,
        ))
    }

    /// The phase of the servo at given frequencies \[rad/s\], continued from zero at rest. A
    /// frequency at which any phase is possible has no bounds.
    ///
    /// ```
    /// # use servoid_identification::{identify, Options, Record, Settling};
    /// # let u: Vec<f64> = (0..400).map(|k| f64::from(k * k / 35 % 2)).collect();
    /// # let y: Vec<f64> = (0..400).map(|k| u[k.max(2) - 2] + 0.001 * f64::from(k as u32 * 7919 % 101)).collect();
    /// # let options = Options { settling: Settling::Samples(31), ..Options::default() };
    /// // A servo that answers two samples late, 10 ms apart and held: its phase is -ω (20 - 5) ms.
    /// let model = identify(&Record::from_slices(0.01, &u, &y)?, &options)?;
    /// let phase = model.phase_at(&[10.0])?[0].phase_deg;
    /// assert!((phase.value.unwrap() + 0.15f64.to_degrees()).abs() < 1.0);
    /// # Ok::<(), servoid_identification::Error>(())
    /// ```
    ///
    /// # Errors
    /// The structure of a hand-made document does not describe a filter bank.
    pub fn phase_at(&self, omega_rad_s: &[f64]) -> Result<Vec<PhaseAt>, Error> {
        let (basis, covariance) = (self.basis()?, covariance_of(self));
        let measured = Measured {
            basis: &basis,
            theta: &self.theta,
            covariance: &covariance,
            step: &self.step,
            frequency: &self.frequency,
            timing: self.timing(),
        };
        let phases = bands::phases_at(&measured, omega_rad_s);
        let phase = |(&omega_rad_s, phase_deg)| PhaseAt {
            omega_rad_s,
            phase_deg,
        };
        Ok(omega_rad_s.iter().zip(phases).map(phase).collect())
    }
}
