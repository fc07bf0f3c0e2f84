//! Findings on the input and the frequencies taken from it: whether they determine the response.

use crate::diagnostics::advice::evidence::{Evidence, two_digits};
use crate::diagnostics::causality::output_lead::output_lead;
use crate::diagnostics::commands::inexact_commands::Inexact;
use crate::diagnostics::times::held_output::input_held_for;
use crate::estimation::Excitation;
use crate::numerics::four_digits;
use crate::results::{Advice, Check, Withheld};
use crate::thresholds::{
    AGAINST_MOTION, ALL_AT_ONCE, DISAGREEMENT, FEEDBACK_SIGNIFICANCE, INPUT_EXPLAINED,
};

/// The remedy where the reference lacks power.
fn sharper(highest_hz: f64) -> String {
    format!(
        "Use a reference with sharp edges, such as a staircase or random steps without a filter before the \
         servo, which has power up to {highest_hz:.0} Hz."
    )
}

/// Beyond this share of the highest frequency that samples show there is hardly another one.
const HIGHEST: f64 = 0.95;

/// Where a reference lacks power, and the remedy.
fn lacking(unexcited_hz: f64, highest_hz: f64) -> (String, String) {
    match unexcited_hz > HIGHEST * highest_hz {
        // Of equal steps at even samples alone, as many upwards as downwards, the transform is 0 there.
        true => (
            format!("at {unexcited_hz:.1} Hz, the highest frequency that these samples show,"),
            "Sample twice as fast: there the response is over. Holds of an even number of samples each have no power there, and odd ones among them have \
             some, which is enough where the noise is low. Or assume that the response falls by 40 dB/decade there: identify with '--frequencies narrow', and compare such models."
                .to_owned(),
        ),
        false => (
            format!("from {unexcited_hz:.1} Hz upwards"),
            sharper(highest_hz),
        ),
    }
}

pub(super) fn excitation(evidence: &Evidence<'_>) -> Option<Advice> {
    let unexcited = evidence.validity.unexcited_above_hz?;
    let highest = evidence.nyquist_hz();
    if let Some(errors) = evidence.validity.excited_by_errors {
        return Some(excited_by_errors(evidence, errors, unexcited));
    }
    if let Some([from, to]) = evidence.model.band_hz() {
        let (what, remedy) = match smooth_runs(evidence) {
            Some(runs) if runs > 2 => ("these runs determine their mean", MORE_RUNS),
            _ => ("the reference determines the response", ""),
        };
        return Some(Advice::new(
            Check::Excitation,
            format!(
                "No bounds of the step response can be given, because {what} from {from:.2} to {to:.1} Hz alone, and much of \
                 the detail of a step is above. What is shown of a step is a picture, made from the {} lowest frequencies.",
                evidence.model.structure.frequencies
            ),
            to,
            highest,
            format!("{remedy}{}", sharper(highest)),
        ));
    }
    let (frequencies, remedy) = lacking(unexcited, highest);
    let (of_runs, each_run) = match smooth_runs(evidence) {
        Some(2) => (TWO_RUNS, EACH_RUN),
        Some(3..) => (SEVERAL_RUNS, MORE_RUNS),
        _ => ("", ""),
    };
    Some(Advice::new(
        Check::Excitation,
        format!(
            "No bounds can be given, because the reference has too little power {frequencies} to \
             determine the response there beside the noise of this recording, where much of the detail of a step is. Metrics that depend on it are left out.{of_runs}"
        ),
        unexcited,
        highest,
        format!("{each_run}{remedy}"),
    ))
}

/// Said of two runs of a smooth reference, each of which has bounds in its band where its errors are noise.
const TWO_RUNS: &str = " Where two runs of such a reference differ by more than noise, they have no bounds of the frequency response together: two do not show by how much runs do.";

/// What to do about it.
const EACH_RUN: &str =
    "Record a third run; or identify each by itself, and look at how far the answers lie apart. ";

/// Said of more runs, none of which by itself is said to lack power.
const SEVERAL_RUNS: &str = " Bounds of several runs are those of their mean, and contain how the servo differs from run to run: few runs show that by several times as much as it is.";

/// What to do about it.
const MORE_RUNS: &str = "Bounds of few runs are wide where these differ, by a few percent of gain or parts of a millisecond: record more of them, or identify one run by itself, whose bounds are those of that run alone, \
                         and may reach farther up. ";

/// How many runs of a smooth reference the record has; `None` of another one.
fn smooth_runs(evidence: &Evidence<'_>) -> Option<usize> {
    let excitation = evidence.explanation.excitation.as_ref();
    let is_smooth = excitation.is_some_and(Excitation::is_smooth);
    let runs = evidence.recorded.map(|record| record.runs().len());
    runs.filter(|_| is_smooth)
}

/// That commands with such `errors` may have been without, and then excite nothing of what these do.
fn excited_by_errors(evidence: &Evidence<'_>, errors: Inexact, power_up_to_hz: f64) -> Advice {
    let highest = evidence.nyquist_hz();
    let which = match evidence.model.band() {
        Some(_) => " of the step response",
        None => "",
    };
    let (finding, remedy) = match errors {
        Inexact::Rounded(step) => (
            format!(
                "No bounds{which} can be given, because the commands are in steps of {}, and part of the response may rest on their rounding alone: \
                 where the servo got finer commands, it got none of that.",
                evidence.input(four_digits(step))
            ),
            format!(
                "Where these are the commands that were sent, to the last digit, that can be stated. Else write them with all their digits. {}",
                sharper(highest)
            ),
        ),
        Inexact::Noisy(sd) => (
            format!(
                "No bounds{which} can be given, because the column of the command has noise of up to {} (standard deviation), and part of the response may rest on \
                 that noise alone: where the commands were measured, the servo got none of it.",
                evidence.input(two_digits(sd))
            ),
            "Write the commands as they are sent, not as they are measured; or record levels in random order, held for different times, which determine \
             more of the response."
                .to_owned(),
        ),
    };
    let finding = format!("{finding} Metrics are left out.");
    Advice::new(
        Check::CommandErrors,
        finding,
        power_up_to_hz,
        highest,
        remedy,
    )
}

/// An output that moves before the input. A record that a linear servo describes down to its noise needs no such question.
pub(super) fn output_leads(evidence: &Evidence<'_>) -> Option<Advice> {
    let record = evidence.recorded.filter(|_| !evidence.has_bounds())?;
    let found = output_lead(record)?;
    Some(Advice::new(
        Check::OutputLeads,
        format!(
            "The output runs ahead of the input by {:.0} ms (correlation {:.2}; with the input ahead, {:.2} at most), and no servo \
             moves before its command: nothing here is a finding on a servo.",
            1e3 * found.lead_s,
            found.correlation,
            found.otherwise
        ),
        found.lead_s,
        0.0,
        "Exchange input and output, if the input is the motion that was measured; else look for a controller that computes the \
         input from the output.",
    ))
}

/// An input that was computed from the output.
pub(super) fn feedback(evidence: &Evidence<'_>) -> Option<Advice> {
    let found = evidence.explanation.feedback?;
    if !evidence.is_closed_loop() {
        return None;
    }
    let explained = found.explained.filter(|_| found.is_explained());
    let (shown_by, value, threshold) = match (explained, found.at_once < -AGAINST_MOTION) {
        (Some(share), _) => (
            format!(
                "past outputs explain {:.0} % of what is new in it",
                100.0 * share
            ),
            share,
            INPUT_EXPLAINED,
        ),
        (None, true) => (
            "it appears to answer within the same sample, and against its own motion".to_owned(),
            found.at_once,
            -AGAINST_MOTION,
        ),
        (None, false) if found.is_all_at_once() => (
            "all of its answer is within the same sample".to_owned(),
            found.share,
            ALL_AT_ONCE,
        ),
        (None, false) => (
            format!(
                "inputs to come explain it (p = {:.0e}), as they also do where commands are written after the servo began to move",
                found.p.max(1e-12)
            ),
            found.p,
            FEEDBACK_SIGNIFICANCE,
        ),
    };
    let (held, sent) = match evidence.recorded.and_then(input_held_for) {
        Some(samples) => (
            format!(
                " So it looks, too, where the servo is sent a finer command than the column has, which changes every {} ms only: then it moves before \
                 its command does.",
                two_digits(1e3 * samples as f64 * evidence.model.sample_period_s)
            ),
            " Write the command with every sample, as it was sent.",
        ),
        None => (String::new(), ""),
    };
    Some(Advice::new(
        Check::Feedback,
        format!(
            "No bounds can be given, because the input follows the output, as where a controller computes the command from the \
             measured motion: {shown_by}. The response is a mixture of the servo and that controller.{held}"
        ),
        value,
        threshold,
        format!(
            "Record in open loop, with a command that was planned before; or take the command that goes into the servo and the \
             servo's own motion, not an error or a sum of both.{sent}"
        ),
    ))
}

/// Frequencies that the input has and the caller left out.
pub(super) fn left_out(evidence: &Evidence<'_>) -> Option<Advice> {
    let left_out = evidence.validity.left_out_above_hz?;
    let metrics = match evidence.validity.withheld {
        Some(Withheld::FrequenciesLeftOut) => " Metrics are left out, too.",
        _ => "",
    };
    let structure = &evidence.model.structure;
    Some(Advice::new(
        Check::LeftOut,
        format!(
            "No bounds can be given, because the {} frequencies that were asked for leave out the response from \
             {left_out:.1} Hz upwards, and what that changes in the rest has no bound.{metrics}",
            structure.frequencies
        ),
        structure.frequencies as f64,
        structure.settling_samples as f64,
        "Take more frequencies, or leave their number to the automatic choice.",
    ))
}

/// An input that is smooth and still determines the response at all frequencies.
pub(super) fn smooth(evidence: &Evidence<'_>) -> Option<Advice> {
    let found = evidence.explanation.excitation?;
    if !found.is_smooth() || evidence.validity.unexcited_above_hz.is_some() {
        return None;
    }
    let effect = match evidence.has_bounds() {
        true => ", which makes the bounds of the step response wide",
        false => "",
    };
    Some(Advice::new(
        Check::SmoothReference,
        format!(
            "The reference is smooth: it has little power above {:.0} Hz{effect}.",
            found.power_up_to_hz
        ),
        found.power_up_to_hz,
        evidence.nyquist_hz(),
        sharper(evidence.nyquist_hz()),
    ))
}

/// Metrics that were left out because they depend on frequencies that the input does not excite. Of commands with errors it is said beside these.
pub(super) fn metrics(evidence: &Evidence<'_>) -> Option<Advice> {
    let unexcited = evidence.validity.unexcited_above_hz?;
    if evidence.validity.excited_by_errors.is_some() {
        return None;
    }
    let left_out = match evidence.model.band() {
        Some(_) => "Delay, rise time and the other metrics of the step response",
        None => "Gain, delay, bandwidth and the other metrics",
    };
    (evidence.validity.withheld == Some(Withheld::InputUnexcited)).then(|| {
        Advice::new(
            Check::UnexcitedMetrics,
            format!(
                "{left_out} are left out: the frequencies that the reference does \
                 not excite may change the step response by more than {:.0} % of its final value.",
                100.0 * DISAGREEMENT
            ),
            unexcited,
            evidence.nyquist_hz(),
            lacking(unexcited, evidence.nyquist_hz()).1,
        )
    })
}

#[cfg(test)]
mod tests {
    use super::lacking;

    #[test]
    fn a_reference_that_lacks_the_highest_frequency_alone_is_not_advised_to_have_it() {
        let (frequencies, remedy) = lacking(5.0, 25.0);
        assert_eq!(frequencies, "from 5.0 Hz upwards");
        assert!(remedy.ends_with("power up to 25 Hz."), "{remedy}");
        let (frequencies, remedy) = lacking(25.0, 25.0);
        assert!(frequencies.starts_with("at 25.0 Hz, the highest"));
        assert!(!remedy.contains("up to"), "{remedy}");
    }
}
