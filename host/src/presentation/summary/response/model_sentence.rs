//! What a model says, in one or two plain sentences.

use super::first_finding::first_finding;
use super::metrics::settling_time;
use crate::data::model_metadata::ModelMetadata;
use crate::data::units::Units;
use crate::presentation::summary::wording::numbers::{digits, percent};
use crate::presentation::summary::wording::strokes::which_step;

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
pub(crate) fn hides_step(model: &Model) -> bool {
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
    parts.extend(overshoot(metrics.overshoot_percent));
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
pub(crate) fn what_answers(model: &Model) -> &'static str {
    match model.linear && !lacks_something(model) {
        true => "the servo",
        false => "the linear model",
    }
}

/// Said behind such figures where no bounds say what they are worth; of a servo that is not linear, bounds come with a sentence of their own.
pub(crate) fn is_picture(model: &Model) -> &'static str {
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
pub(crate) fn has_likely_times(model: &Model) -> bool {
    !model.advice.iter().any(Advice::doubts_times)
}

/// When a servo is half way, and when it stays at its end, as parts of a sentence.
pub(crate) fn half_way_and_settled(metrics: &Metrics) -> Vec<String> {
    let half = in_ms(metrics.t50_s).map(|time| format!("is half way after {time}"));
    // A response of which the record shows no end stays there at some later time.
    let settled = settling_time(metrics);
    let has_end = metrics.bounds.withdrawn().is_some() || settled.upper.is_some();
    let settled = in_ms(settled)
        .filter(|_| has_end)
        .map(|time| format!("stays within 2 % of its end after {time}"));
    half.into_iter().chain(settled).collect()
}

/// "32 ms" where no more is to be said, "107 ms (84 to 131)" of what is hardly known, and "at most 22 ms" of what may be nothing; `None` of what may be anything,
/// and of a time before the command, which no servo has.
fn in_ms(time: Interval) -> Option<String> {
    let whole = |seconds: f64| format!("{:.0}", 1e3 * seconds);
    let seconds = time.value?;
    let is_impossible = time.upper.unwrap_or(seconds) < 0.0;
    if is_open(time) || is_impossible {
        return None;
    }
    Some(match time.ends() {
        Some([lower, upper]) if lower <= 0.0 => match upper > 0.0 {
            true => format!("at most {:.0} ms", (1e3 * upper).ceil()),
            false => "0 ms".to_owned(),
        },
        Some([lower, upper]) if is_coarse(time) && whole(lower) != whole(upper) => {
            format!(
                "{} ms ({} to {})",
                whole(seconds),
                whole(lower),
                whole(upper)
            )
        }
        _ => format!("{} ms", whole(seconds)),
    })
}

/// Whether nothing bounds a figure above, though it has an interval.
fn is_open(of: Interval) -> bool {
    of.lower.is_some() && of.upper.is_none()
}

/// Half the width of an interval as a part of its value, from which the value does not stand alone.
const COARSE: f64 = 0.1;

fn is_coarse(of: Interval) -> bool {
    let ends = of.value.zip(of.ends());
    ends.is_some_and(|(value, [lower, upper])| {
        (upper - value).max(value - lower) > COARSE * value.abs()
    })
}

/// By how much it overshoots, and within what where that is hardly known.
fn overshoot(share: Interval) -> Option<String> {
    let value = share.value.filter(|_| !is_open(share))?;
    let shown = |percent: f64| format!("{percent:.1}");
    let ends = share.lower.zip(share.upper);
    let coarse =
        ends.filter(|(lower, upper)| (upper - value).max(value - lower) > COARSE_OVERSHOOT);
    Some(match coarse {
        Some((lower, upper)) if lower < NO_OVERSHOOT_PERCENT => {
            format!("overshoots by at most {} %", shown(upper))
        }
        Some((lower, upper)) => format!(
            "overshoots by {} % ({} to {})",
            shown(value),
            shown(lower),
            shown(upper)
        ),
        None if value < NO_OVERSHOOT_PERCENT => "does not overshoot".to_owned(),
        // What may be none is no overshoot of that size.
        None if ends.is_some_and(|(lower, _)| lower <= 0.0) => {
            format!(
                "overshoots by at most {} %",
                shown(share.upper.unwrap_or(value))
            )
        }
        None => format!("overshoots by {} %", shown(value)),
    })
}

/// Half the width of the interval of an overshoot from which it does not stand alone \[% of the final value\].
const COARSE_OVERSHOOT: f64 = 1.0;

/// Where the response ends; or that it does not, as far as that can be judged.
fn end(model: &Model, units: Units<'_>) -> Option<String> {
    if model.may_answer_later_steps() {
        return Some("shows no settling time".to_owned());
    }
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
pub(crate) fn certainty(model: &Model) -> String {
    match &model.step.bounds {
        Bounds::Valid(bounds) => {
            let linear = match model.linear {
                true => "",
                false => {
                    "The servo is not linear: this describes the motion that was recorded. Another one, of other levels in another order, may be farther off than the bounds. "
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_time_is_not_finer_than_it_is_known() {
        let shown = |value, lower, upper| in_ms(Interval::new(value, lower, upper)).unwrap();
        assert_eq!(shown(0.032, 0.031, 0.033), "32 ms");
        assert_eq!(shown(0.1074, 0.0835, 0.1311), "107 ms (84 to 131)");
        assert_eq!(shown(0.0089, 0.0, 0.02166), "at most 22 ms");
        assert_eq!(shown(0.0015, 0.0012, 0.0017), "2 ms (1 to 2)");
        let unknown = Interval {
            value: Some(0.0132),
            ..Interval::default()
        };
        assert_eq!(in_ms(unknown).unwrap(), "13 ms");
        let before = Interval {
            value: Some(-0.0021),
            ..Interval::default()
        };
        assert_eq!(in_ms(before), None);
    }

    #[test]
    fn an_overshoot_that_may_be_none_is_at_most_so_large() {
        let shown = |value, lower, upper| overshoot(Interval::new(value, lower, upper)).unwrap();
        assert_eq!(shown(4.46, 4.1, 4.8), "overshoots by 4.5 %");
        assert_eq!(shown(3.92, 1.95, 8.9), "overshoots by 3.9 % (1.9 to 8.9)");
        assert_eq!(shown(5.7, 0.0, 11.7), "overshoots by at most 11.7 %");
        assert_eq!(shown(0.1, 0.0, 0.3), "does not overshoot");
        let open = Interval {
            value: Some(0.0),
            lower: Some(0.0),
            upper: None,
        };
        assert_eq!((overshoot(open), in_ms(open)), (None, None));
    }
}
