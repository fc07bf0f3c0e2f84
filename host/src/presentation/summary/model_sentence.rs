//! What a model says, in one or two plain sentences.

use super::first_finding::first_finding;
use super::metrics::settling_time;
use super::numbers::{digits, percent};
use super::strokes::which_step;
use crate::data::model_metadata::ModelMetadata;
use crate::data::units::Units;

use servoid_identification::results::{
    Advice, Bounds, Interval, Metrics, Model, Reason, StepBounds,
};

/// What kind of servo, how fast, how sure.
#[must_use]
pub fn model_sentence(model: &Model, of: &ModelMetadata) -> String {
    // Motion is no finding on a servo where something else comes first, or where the model does not follow the recording.
    match first_finding(model) {
        Some(_) => certainty(model),
        None if !model.predicts() => format!(
            "How the servo answers a step is not determined: the linear model fits the recording to {:.1} % only. {}",
            model.fit.simulation_percent,
            certainty(model)
        ),
        None if hides_step(model) || model.band().is_some() => certainty(model),
        None => format!("{} {}", motion(model, of), certainty(model)),
    }
}

/// Whether the band is wider than the step itself, so that no figure of it is a finding.
pub(super) fn hides_step(model: &Model) -> bool {
    let gain = model.step.value.last().map_or(1.0, |gain| gain.abs());
    let whole = |bounds: &StepBounds| bounds.mean_half_widths().1;
    (model.step.bounds.valid()).is_some_and(|bounds| whole(bounds) > gain)
}

/// How the servo answers a step of the command.
fn motion(model: &Model, of: &ModelMetadata) -> String {
    let metrics = &model.metrics;
    let mut parts = Vec::new();
    if has_likely_times(model) {
        let begins = in_ms(metrics.delay_s);
        parts.extend(begins.map(|time| format!("passes 5 % of its way after {time}")));
        parts.extend(half_way_and_settled(metrics));
    }
    parts.extend(
        metrics
            .overshoot_percent
            .value
            .map(|share| match share < NO_OVERSHOOT_PERCENT {
                true => "does not overshoot".to_owned(),
                false => format!("overshoots by {share:.1} %"),
            }),
    );
    parts.extend(end(model, of.units()));
    match parts.pop() {
        None => "How the servo answers a step is not determined.".to_owned(),
        Some(last) => {
            let all = match parts.is_empty() {
                true => last,
                false => format!("{}, and {last}", parts.join(", ")),
            };
            format!(
                "After a step of the command{} {} {all}.{}",
                which_step(of),
                what_answers(model),
                is_picture(model)
            )
        }
    }
}

/// Whose figures those of a step response are: gain and times of a linear model are not those of a servo that is not linear.
pub(super) fn what_answers(model: &Model) -> &'static str {
    match model.linear && !lacks_something(model) {
        true => "the servo",
        false => "the linear model",
    }
}

/// Said behind such figures where no bounds say what they are worth; of a servo that is not linear, bounds come with a sentence of their own.
pub(super) fn is_picture(model: &Model) -> &'static str {
    match lacks_something(model) {
        true => " That is a picture of this recording, and the servo itself may do otherwise.",
        false => "",
    }
}

/// Whether the model lacks something that its errors show.
fn lacks_something(model: &Model) -> bool {
    model.step.bounds.withdrawn() == Some(Reason::ErrorsNotNoise)
}

/// Whether the response takes times that a servo can take, which a finding says where it does not.
pub(super) fn has_likely_times(model: &Model) -> bool {
    !model.advice.iter().any(Advice::doubts_times)
}

/// When a servo is half way, and when it stays at its end, as parts of a sentence.
pub(super) fn half_way_and_settled(metrics: &Metrics) -> Vec<String> {
    let half = in_ms(metrics.t50_s).map(|time| format!("is half way after {time}"));
    // A response of which the record shows no end stays there at some later time.
    let settled = settling_time(metrics);
    let has_end = metrics.bounds.withdrawn().is_some() || settled.upper.is_some();
    let settled = in_ms(settled)
        .filter(|_| has_end)
        .map(|time| format!("stays within 2 % of its end after {time}"));
    half.into_iter().chain(settled).collect()
}

fn in_ms(time: Interval) -> Option<String> {
    time.value.map(|seconds| format!("{:.0} ms", 1e3 * seconds))
}

/// Where the response ends; or that it does not, as far as that can be judged.
fn end(model: &Model, units: Units<'_>) -> Option<String> {
    if model.step.bounds.withdrawn() == Some(Reason::ResponseNotOver) {
        let judged_s = model.structure.settling_samples as f64 * model.sample_period_s;
        return Some(format!(
            "is not seen to come to rest within {:.0} ms",
            1e3 * judged_s
        ));
    }
    let unit = units
        .gain()
        .map(|unit| format!(" {unit}"))
        .unwrap_or_default();
    let gain = model.metrics.dc_gain.value?;
    // A small one may be a factor of units, such as 0.01745 rad/deg.
    let gain = match gain.abs() < 0.1 {
        true => digits(gain, 4),
        false => format!("{gain:.3}"),
    };
    Some(format!("ends at {gain}{unit} for each unit of the command"))
}

/// An overshoot that is none to the eye (% of the final value).
const NO_OVERSHOOT_PERCENT: f64 = 0.5;

/// How sure the step response is.
pub(super) fn certainty(model: &Model) -> String {
    match &model.step.bounds {
        Bounds::Valid(bounds) => {
            let linear = match model.linear {
                true => "",
                false => {
                    "The servo is not linear: this describes the motion that was recorded, and another one may differ. "
                }
            };
            let (_, whole) = bounds.mean_half_widths();
            let gain = model.step.value.last().map_or(1.0, |gain| gain.abs());
            if hides_step(model) {
                return format!(
                    "The recording does not show how the servo answers a step: its band, at {} % confidence, is wider than the step.",
                    percent(bounds.level)
                );
            }
            format!(
                "{linear}The whole step response is known to ±{:.2} % of its end on average and ±{:.2} % where it is widest, with {} % confidence.",
                100.0 * whole / gain,
                100.0 * bounds.widest_half_width() / gain,
                percent(bounds.level)
            )
        }
        Bounds::Withdrawn(reason) => match known_band(model) {
            Some(known) => format!(
                "{known} How the servo answers a step is not determined, because {}: see the advice.",
                reason.because()
            ),
            None => format!(
                "No bounds can be given, because {}: see the advice.",
                reason.because()
            ),
        },
    }
}

/// How well the frequency response is known, where it is known in a band alone.
fn known_band(model: &Model) -> Option<String> {
    let bounds = model.band()?;
    let [from, to] = model.band_hz()?;
    let [(decibels, most_decibels), (degrees, most_degrees)] = bounds.half_widths();
    Some(format!(
        "From {} to {} Hz the frequency response is known to ±{} dB and ±{} degrees on average, and ±{} dB and ±{} degrees where it is least so, with {} % \
         confidence at each frequency.",
        digits(from, 2),
        digits(to, 3),
        digits(decibels, 2),
        digits(degrees, 2),
        digits(most_decibels, 2),
        digits(most_degrees, 2),
        percent(bounds.level)
    ))
}
