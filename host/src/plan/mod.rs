//! What a run will tell before it is made: how wide the band of the step response will be, where the
//! reference has its power, and what it cannot answer at all.
//!
//! Runs of a simulated servo are identified as real ones will be: what is not linear in it widens the band, and
//! only trying shows by how much. Where only a model is known, nothing but the linear part can be told. There the
//! width of a band depends on the reference, on the noise, and on how long the response lasts; the response
//! itself does not enter. So it can be computed beforehand from the covariance that generalised least squares
//! will have, σ² (Z_D'Z_D)^-1, for this reference's own regressor Z under a stated noise
//! σ, D. Only the structure (N, n) is not known before the data are: it is what identification itself
//! chooses on simulated runs of the assumed servo.

mod answers;
mod assumed;
mod needed;
mod pilot;
mod spectrum;
mod text;

pub use answers::Answer;
pub use assumed::{Assumed, AssumedError, noise_rms};
pub use needed::{MOST_RUNS, Needed, Reach, Shrinking};
pub use spectrum::{Line, Octave, Spectrum};
pub use text::{figure, of_plan};

use crate::data::recording::as_toml;
use crate::instrument::reference::{Kind, ReferenceSpec, in_words, seconds};
use crate::instrument::rig::capture::ROLL_FRAMES;
use pilot::Expected;
use serde::Serialize;
use servoid_identification::metrics::Metrics;
use servoid_identification::settling_time::MARGIN;
use servoid_identification::step_response::{StepBounds, StepResponse};
use servoid_identification::{Error, Model};
use servoid_protocol::Reference;

/// What is asked.
#[derive(Clone, Debug)]
pub struct Question {
    /// What the servo will be told.
    pub reference: Reference,
    /// Change of the pulse for one degree (µs/deg).
    pub us_per_degree: f64,
    /// How often it will be told.
    pub runs: usize,
    /// The servo and the noise that are assumed.
    pub assumed: Assumed,
    /// Confidence level of the bounds.
    pub level: f64,
    /// Half width of the whole curve's band that is wanted, where it is widest (percent of the step).
    pub wanted_percent: Option<f64>,
}

impl Question {
    /// Whether the plan holds for a linear servo alone: its model is all that is known, and the reference does
    /// not let it rest.
    fn relies_on_linearity(&self) -> bool {
        let Assumed {
            model, simulation, ..
        } = &self.assumed;
        let settling_s = model.structure.settling_samples as f64 * model.sample_period_s;
        // N is a margin longer than the response.
        simulation.is_none() && !rests(&self.reference, settling_s / MARGIN)
    }
}

/// Simulated identifications behind each line of the table of references: what tells them apart is far more
/// than the scatter of one.
const PILOTS_OF_ALTERNATIVES: u64 = 1;

/// How wide the bands are (percent of the step, half of the width).
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Widths {
    /// Confidence level.
    pub level: f64,
    /// The whole curve's band, where it is widest.
    pub widest_percent: f64,
    /// The whole curve's band, on average.
    pub mean_percent: f64,
    /// The bounds of single points, on average.
    pub mean_pointwise_percent: f64,
    /// The part of each that more runs do not narrow: what frequencies without power may hide.
    pub bias_percent: f64,
    /// The part of the widest that runs of a simulated servo have beyond what noise explains, the bias
    /// included: they repeat it, so that more of them do not narrow it.
    pub beyond_noise_percent: f64,
}

impl Widths {
    /// Of the bounds of a step response.
    #[must_use]
    pub fn of(bounds: &StepBounds) -> Self {
        let (pointwise, whole) = bounds.mean_half_widths();
        Self {
            level: bounds.level,
            widest_percent: 100.0 * bounds.widest_half_width(),
            mean_percent: 100.0 * whole,
            mean_pointwise_percent: 100.0 * pointwise,
            bias_percent: 100.0 * bounds.bias(),
            beyond_noise_percent: 0.0,
        }
    }

    /// The mean of several, which are of one level; of none, nothing is known.
    pub(crate) fn mean(all: &[Self]) -> Self {
        let mean = |of: fn(&Self) -> f64| all.iter().map(of).sum::<f64>() / all.len() as f64;
        Self {
            level: all.first().map_or(f64::NAN, |w| w.level),
            widest_percent: mean(|w| w.widest_percent),
            mean_percent: mean(|w| w.mean_percent),
            mean_pointwise_percent: mean(|w| w.mean_pointwise_percent),
            bias_percent: mean(|w| w.bias_percent),
            beyond_noise_percent: mean(|w| w.beyond_noise_percent),
        }
    }

    /// The widest as more runs change it.
    #[must_use]
    pub fn shrinking(&self) -> Shrinking {
        Shrinking {
            widest_percent: self.widest_percent,
            stays_percent: self.bias_percent.max(self.beyond_noise_percent),
        }
    }
}

/// One reference beside the others, each as it is without options, at the same amplitude.
#[derive(Clone, Debug, Serialize)]
pub struct Alternative {
    /// Its name.
    pub reference: &'static str,
    /// How long one run takes, with its rest (s).
    pub run_s: f64,
    /// Half width of the whole curve's band, where it is widest (percent of the step); `None` where it
    /// cannot be identified, or not with bounds.
    pub widest_percent: Option<f64>,
    /// What the band would be after one minute of such runs: what makes references of different length
    /// comparable.
    pub widest_percent_in_a_minute: Option<f64>,
    /// Whether these figures hold for a linear servo alone: its model is all that is known, and it does not
    /// rest on the way.
    pub only_if_linear: bool,
    /// What is needed for the wanted band; `None` also where a reasonable number of runs does not give it.
    pub needed: Option<Needed>,
    /// What it answers beside the linear response.
    pub answers: Vec<&'static str>,
}

/// What a run will tell.
#[derive(Clone, Debug, Serialize)]
pub struct Plan {
    /// The reference as a recording's header says it.
    pub reference: toml::Table,
    /// The reference in words.
    pub description: String,
    /// How long the reference takes (s).
    pub reference_s: f64,
    /// How long one run takes, with its rest (s).
    pub run_s: f64,
    /// Runs.
    pub runs: usize,
    /// The servo that is assumed, in words.
    pub servo: String,
    /// Standard deviation of the noise that is assumed (deg).
    pub noise_deg: f64,
    /// Coefficients of the noise that is assumed, d_1..d_d of 1/D(z).
    pub noise_ar: Vec<f64>,
    /// N and n that identification will probably choose.
    pub settling_samples: usize,
    /// Number of frequencies.
    pub frequencies: usize,
    /// The band of the step response; `None` where identification will find the errors to be no noise, so
    /// that it gives no bounds.
    pub band: Option<Widths>,
    /// The metrics with the intervals that they will have, if the servo is the assumed one; `None` without
    /// a band.
    pub metrics: Option<Metrics>,
    /// Where the reference has its power.
    pub spectrum: Spectrum,
    /// What it answers, and what it cannot.
    pub answers: Vec<Answer>,
    /// Whether all this holds for a linear servo alone.
    pub only_if_linear: bool,
    /// Half width of the band that is wanted (percent of the step).
    pub wanted_percent: Option<f64>,
    /// What is needed for it; `None` also where a reasonable number of runs does not give it.
    pub needed: Option<Needed>,
    /// All references beside each other, the best first.
    pub alternatives: Vec<Alternative>,
    /// The assumed servo's response with the bounds that are to be expected.
    #[serde(skip)]
    pub step: StepResponse,
}

impl Plan {
    /// Plans a run.
    ///
    /// # Errors
    /// What identification would say after the run: the reference is too short, or excites too little.
    pub fn of(question: &Question) -> Result<Self, Error> {
        let expected = Expected::of(question)?;
        let reference = &question.reference;
        let band = expected.band;
        let Model { noise, .. } = &question.assumed.model;
        Ok(Self {
            reference: as_toml(reference),
            description: in_words(reference, question.us_per_degree),
            reference_s: seconds(reference.frames()),
            run_s: run_s(reference),
            runs: question.runs,
            servo: question.assumed.name.clone(),
            noise_deg: noise_rms(noise),
            noise_ar: noise.ar.clone(),
            settling_samples: expected.model.structure.settling_samples,
            frequencies: expected.model.structure.frequencies,
            band,
            metrics: match band {
                Some(_) => expected.model.metrics_anew()?.into_valid(),
                None => None,
            },
            spectrum: Spectrum::of(question),
            answers: answers::of(&expected.pilot, &expected.record),
            only_if_linear: question.relies_on_linearity(),
            wanted_percent: question.wanted_percent,
            needed: band.and_then(|band| needed(question, &band)),
            alternatives: alternatives(question, &expected),
            step: expected.model.step,
        })
    }
}

/// How long one run takes (s).
fn run_s(reference: &Reference) -> f64 {
    seconds(reference.frames() + 2 * u32::from(ROLL_FRAMES))
}

/// What the wanted width takes; `None` where none is wanted, or where a reasonable number of runs does not
/// give it.
fn needed(question: &Question, band: &Widths) -> Option<Needed> {
    let band_percent = question.wanted_percent?;
    match band.shrinking().reach(band_percent, question.runs) {
        Reach::Runs(runs) => Some(Needed {
            band_percent,
            runs,
            seconds: runs as f64 * run_s(&question.reference),
        }),
        Reach::TooManyRuns | Reach::Never => None,
    }
}

/// Every reference as it is without options, at the same amplitude. One of them may be the question itself, of
/// which is known what is `expected`.
fn alternatives(question: &Question, expected: &Expected) -> Vec<Alternative> {
    let (low, high) = question.reference.extremes_us();
    let amplitude_us = f64::from(high.max(low.saturating_neg()));
    let kinds = [
        Kind::Staircase,
        Kind::Stairs,
        Kind::Prbs,
        Kind::Sweep,
        Kind::Multisine,
    ];
    let wishes = kinds.map(|kind| ReferenceSpec {
        kind,
        amplitude_deg: Some(amplitude_us / question.us_per_degree.abs()),
        ..ReferenceSpec::default()
    });
    // At an amplitude at which one of them cannot be, it is no alternative.
    let questions = wishes.iter().filter_map(|wish| {
        let granted = wish.grant(question.us_per_degree).ok()?;
        Some(Question {
            reference: granted.reference,
            runs: 1,
            ..question.clone()
        })
    });
    let mut all: Vec<Alternative> = std::thread::scope(|scope| {
        let threads: Vec<_> = questions
            .map(|other| {
                scope.spawn(move || {
                    if other.reference == question.reference && question.runs == 1 {
                        return alternative(&other, Some(expected));
                    }
                    let expected = Expected::of_pilots(&other, PILOTS_OF_ALTERNATIVES).ok();
                    alternative(&other, expected.as_ref())
                })
            })
            .collect();
        threads
            .into_iter()
            .filter_map(|thread| thread.join().ok())
            .collect()
    });
    let rank = |a: &Alternative| {
        let width = a.widest_percent_in_a_minute.unwrap_or(f64::INFINITY);
        (a.only_if_linear, width)
    };
    all.sort_by(|a, b| {
        let ((a_linear, a), (b_linear, b)) = (rank(a), rank(b));
        a_linear.cmp(&b_linear).then(a.total_cmp(&b))
    });
    all
}

/// Whether the servo rests on the way, for as long as it takes to settle. What it does while it is still under
/// way depends on where it comes from, unless it is linear.
fn rests(reference: &Reference, settling_s: f64) -> bool {
    let is_long_enough = |frames: u16| seconds(frames.into()) >= settling_s;
    match reference {
        Reference::Staircase(staircase) => is_long_enough(staircase.longest_hold_frames),
        Reference::Stairs(stairs) => is_long_enough(stairs.hold_frames),
        Reference::Prbs(prbs) => is_long_enough(prbs.chip_frames),
        Reference::Steps(steps) => steps.held().any(|step| is_long_enough(step.hold_frames)),
        Reference::Sweep(_) | Reference::Multisine(_) => false,
    }
}

/// A reference, and what is `expected` of it where it can be identified.
fn alternative(question: &Question, expected: Option<&Expected>) -> Alternative {
    const MINUTE_S: f64 = 60.0;
    let run_s = run_s(&question.reference);
    let band = expected.and_then(|e| e.band);
    let answers = expected.map_or_else(Vec::new, |e| answers::of(&e.pilot, &e.record));
    Alternative {
        reference: question.reference.name(),
        run_s,
        widest_percent: band.map(|b| b.widest_percent),
        widest_percent_in_a_minute: band.map(|b| b.shrinking().widest_after(MINUTE_S / run_s)),
        only_if_linear: question.relies_on_linearity(),
        needed: band.and_then(|b| needed(question, &b)),
        answers: answers
            .into_iter()
            .filter(|answer| answer.answered)
            .map(|answer| answer.question)
            .collect(),
    }
}

#[cfg(test)]
mod tests;
