//! Findings on the response: whether it is over, and what of it was left out.

use super::errors;
use super::evidence::Evidence;
use crate::options::Frequencies;
use crate::results::{Advice, Check, SelectedBy};
use crate::selection::Choice;
use crate::thresholds::{DETECTION, MARGIN};

/// The choice of the settling time, unless it was overruled because the errors are not noise.
fn trusted_choice<'a>(evidence: &Evidence<'a>) -> Option<&'a Choice> {
    let explanation = evidence.explanation;
    explanation
        .settling
        .as_ref()
        .filter(|_| explanation.model_errors.is_none())
}

pub(super) fn settled(evidence: &Evidence<'_>) -> Option<Advice> {
    let choice = trusted_choice(evidence).filter(|choice| !choice.settled)?;
    let period = evidence.model.sample_period_s;
    let longest = choice.longest as f64 * period;
    let moving = choice.detected as f64 * period;
    Some(Advice::new(
        Check::Settled,
        format!(
            "The response has not settled within the longest time that can be judged, {longest:.3} \
             s: it still moves at {moving:.3} s. The bounds hold up to there; the final value is not \
             certain."
        ),
        choice.detected as f64,
        choice.longest as f64 / MARGIN,
        format!(
            "Record with holds of at least {:.2} s and at least {:.1} s in all.",
            MARGIN * longest,
            7.0 * MARGIN * longest
        ),
    ))
}

pub(super) fn repeats(evidence: &Evidence<'_>) -> Option<Advice> {
    let settling = evidence.explanation.settling.as_ref()?;
    let repeats = settling.repeats_after? as f64 * evidence.model.sample_period_s;
    Some(Advice::new(
        Check::Repeats,
        format!(
            "The reference repeats itself after {repeats:.3} s: what the response does later than that cannot be \
             told from what it does before, and is taken to be over."
        ),
        repeats,
        settling.longest as f64 * evidence.model.sample_period_s,
        "Use holds of different lengths, as a staircase or random steps have, to see later parts of the \
         response.",
    ))
}

/// What may go on below the noise after the settling time, in standard deviations, without spoiling
/// bounds.
const HIDDEN: f64 = 0.5;

/// Of an exponential tail of the size A of the response, seen down to c standard deviations s, the share
/// (c s / A)^κ is left after κ times as long: c (c s / A)^(κ-1) standard deviations.
pub(super) fn hidden_tail(evidence: &Evidence<'_>) -> Option<Advice> {
    trusted_choice(evidence).filter(|choice| choice.settled && choice.detected > 1)?;
    let step = &evidence.model.step;
    let size = step.value.last()?.abs();
    let sd = step.bounds.valid()?.sd.iter().copied().fold(0.0, f64::max);
    let hidden = DETECTION * (DETECTION * sd / size).powf(MARGIN - 1.0);
    if errors::nonlinear(evidence) {
        // More motion would bring more of the errors, not less noise.
        return (hidden > HIDDEN).then(|| hidden_by_errors(hidden, sd / size));
    }
    (hidden > HIDDEN).then(|| {
        Advice::new(
            Check::HiddenTail,
            format!(
                "The noise is large for what this input excites: a slow end or a ringing of the response below {:.0} % of the final \
                 value cannot be seen, and what is left of it after the settling time may be {hidden:.1} \
                 standard deviations. The bounds may hold less often than they say.",
                100.0 * DETECTION * sd / size
            ),
            hidden,
            HIDDEN,
            "Record longer, or use larger steps with sharper edges.",
        )
    })
}

/// The same of a servo whose errors grow with its motion; `share` is a standard deviation of the final
/// value.
fn hidden_by_errors(hidden: f64, share: f64) -> Advice {
    Advice::new(
        Check::HiddenTail,
        format!(
            "The errors of a servo that is not linear hide what its response does below {:.0} % of the final value: \
             a slow end or a ringing cannot be seen.",
            100.0 * DETECTION * share
        ),
        hidden,
        HIDDEN,
        "Record steps of one size that are held until the servo rests.",
    )
}

pub(super) fn responds(evidence: &Evidence<'_>) -> Option<Advice> {
    let choice = trusted_choice(evidence).filter(|choice| choice.detected <= 1)?;
    let gain = &evidence.model.metrics.dc_gain;
    let sign_is_known = gain
        .lower
        .zip(gain.upper)
        .is_some_and(|(lower, upper)| lower * upper > 0.0);
    let finding = if sign_is_known {
        "No moment of the response stands out of the noise: that the output follows the input shows in the gain alone, \
         and how it gets there is not known."
    } else {
        "The output shows no response to the input above the noise."
    };
    Some(Advice::new(
        Check::Response,
        finding.to_owned(),
        choice.detected as f64,
        1.0,
        "Check that input and output belong together, and use larger steps.",
    ))
}

pub(super) fn truncated(evidence: &Evidence<'_>) -> Option<Advice> {
    let model = evidence.model;
    let basis = model.basis().ok()?;
    if basis.has_all_frequencies() {
        return None;
    }
    let bounds = model.step.bounds.valid()?;
    let bias = bounds.truncation_bias;
    let noise = bounds.mean_half_widths().0 - bias;
    let highest = basis.highest_hz(model.sample_period_s);
    let decade = if model.structure.selected_by == SelectedBy::Narrow {
        40
    } else {
        20
    };
    let automatic = evidence.options.frequencies == Frequencies::Auto;
    let errors = evidence.explanation.model_errors.as_ref();
    // The choice for prediction leaves out what does not help it, whether the input has it or not.
    let low_passed = errors.is_none_or(|errors| errors.unexcited_above_hz.is_some());
    let (finding, remedy) = if automatic && !low_passed {
        (
            format!(
                "The {} frequencies that predict best reach up to {highest:.1} Hz only",
                model.structure.frequencies
            ),
            "Nothing needs to be done for prediction; ask for more frequencies to look at detail.",
        )
    } else if automatic {
        (
            match highest > 0.0 {
                true => format!(
                    "The input has too little power above {highest:.1} Hz to tell the response there"
                ),
                false => {
                    "The input moves too slowly to tell more of the response than a gain".to_owned()
                }
            },
            "Use a reference with sharp edges, without a filter before the servo.",
        )
    } else {
        (
            format!(
                "The {} frequencies reach up to {highest:.1} Hz only",
                model.structure.frequencies
            ),
            "Take more frequencies, or leave their number to the automatic choice.",
        )
    };
    // Two digits that count.
    let digits = (1.0 - bias.log10().floor()).clamp(0.0, 9.0) as usize;
    if evidence.withdrawn.is_some() {
        let structure = &model.structure;
        return Some(Advice::new(
            Check::Truncation,
            format!("{finding}."),
            structure.frequencies as f64,
            structure.settling_samples as f64,
            remedy,
        ));
    }
    Some(Advice::new(
        Check::Truncation,
        format!(
            "{finding}. The bands contain {bias:.digits$} for what is left out, which holds if the response falls by at \
             least {decade} dB/decade above."
        ),
        bias,
        noise,
        remedy,
    ))
}
