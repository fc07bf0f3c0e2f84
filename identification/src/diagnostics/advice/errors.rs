//! Findings on the errors: whether they are noise, and whether the noise model fits them.

use crate::data::leaves_neutral;
use crate::diagnostics::advice::evidence::Evidence;
use crate::diagnostics::linearity::Linearity;
use crate::diagnostics::misfit::slow_errors::SlowErrors;
use crate::diagnostics::misfit::{Misfit, MisfitEvidence};
use crate::diagnostics::runs::run_scatter::RunComparison;
use crate::options::{MAX_AUTO_ORDER, NoiseOrder};
use crate::results::{Advice, Bounds, Check, Reason, Withheld};
use crate::thresholds::{
    DISAGREEMENT, FEW_DEGREES, MARGIN, MATERIAL_MISFIT_PERCENT, POOR_PREDICTION_PERCENT,
    RESIDUAL_SIGNIFICANCE, SLOW_ROOT, STEPS_FOLLOWED, UNEXPLAINED_PERCENT, WHITENING_COST_POINTS,
};

pub(super) fn model_error(evidence: &Evidence<'_>) -> Option<Advice> {
    let misfit = evidence.misfit().filter(|_| !evidence.is_closed_loop())?;
    let taken = match evidence.model.structure.noise_order {
        0 => "plain",
        _ => "generalised",
    };
    // With a smooth input, the effect of the left-out frequencies on the others looks like an error of the servo. That the reference lacks
    // power has been said, and is reason enough.
    let (smooth, lacking) = (
        misfit.unexcited_above_hz,
        evidence.validity.unexcited_above_hz,
    );
    let what = match (smooth, lacking) {
        (Some(_), Some(_)) => "This reference is too smooth to show whether the errors are noise",
        (None, Some(_)) => "Nor are the errors noise",
        _ => "No bounds can be given, because the errors are not noise",
    };
    let smooth = match (smooth, lacking) {
        (Some(_), None) => {
            " The input is too smooth to show whether the servo or the input is the cause."
        }
        _ => "",
    };
    let (chosen_by, use_of_model) = match misfit.candidates.first() {
        Some(best) => (
            "how well it predicts parts not seen",
            match best.cross_validated_percent {
                percent if percent < POOR_PREDICTION_PERCENT => format!(
                    "use the linear model for nothing else than this recording (it met parts not seen to {percent:.0} % only)"
                ),
                percent => format!(
                    "use the linear model for prediction alone (it met parts not seen to {percent:.0} %), not for comparison"
                ),
            },
        ),
        None => (
            "how well it simulates this record, as none that was tried predicts parts not seen",
            "use the linear model as a picture of this recording alone".to_owned(),
        ),
    };
    let noise = evidence.explanation.command_noise.is_some();
    let settling = evidence.model.structure.settling_samples;
    let (reason, value, threshold) = reason_in_words(misfit, noise, settling);
    let slow = evidence.slow_errors();
    let by_drift = slow.map_or_else(String::new, |slow| format!(" {}.", slow.in_words()));
    let record = match misfit.evidence {
        _ if slow.is_some() => remedy_of_slow_errors(evidence),
        MisfitEvidence::MovesAgain(_) | MisfitEvidence::OutlastsHolds(_) => {
            "Record levels in random order, or holds of different lengths (or more of both, where they are), to see what the answer depends on"
        }
        MisfitEvidence::StatedBeyondHold(_) => {
            "Leave the settling time out, or state one that is no longer than a hold"
        }
        // Without rests a smooth motion lets what was before the record pass for an error.
        _ if misfit.unexcited_above_hz.is_some() => {
            "Record two seconds of rest before and after this motion, or steps that are held until the servo rests"
        }
        // Steps of several sizes are several answers, however long each is held.
        _ => "Record steps of one size that are held until the servo rests",
    };
    Some(Advice::new(
        Check::ModelError,
        format!(
            "{what}: {reason}. The structure was chosen by \
             {chosen_by}, and {taken} least squares was taken.{smooth}{by_drift}"
        ),
        value,
        threshold,
        format!("{record}; {use_of_model}."),
    ))
}

fn remedy_of_slow_errors(evidence: &Evidence<'_>) -> &'static str {
    SlowErrors::remedy(!evidence.explanation.drift.is_empty())
}

/// "p = 2.3e-7"; smaller ones than any table has are all the same.
fn probability(p: f64) -> String {
    const LEAST: f64 = 1e-12;
    if p < LEAST {
        format!("p < {LEAST:.0e}")
    } else {
        format!("p = {p:.1e}")
    }
}

/// Why errors are not noise with N of `settling` samples, the number that shows it, and its threshold. `has_noise` where the command has, which
/// hides how long it is held.
fn reason_in_words(misfit: &Misfit, has_noise: bool, settling: usize) -> (String, f64, f64) {
    let unexplained = misfit.unexplained_percent();
    let left = format!("simulation leaves {unexplained:.0} % of the motion (rms) unexplained");
    match misfit.evidence {
        MisfitEvidence::Whitening => {
            let (plain, generalised) = (misfit.least_squares_percent, misfit.generalised_percent);
            let simulated = |percent: f64| match percent > 0.0 {
                true => format!("explains {percent:.1} % of the motion"),
                false => "explains none of the motion".to_owned(),
            };
            let words = format!(
                "the model of servo and noise together {}, and one of the servo alone {}",
                simulated(generalised),
                simulated(plain)
            );
            (words, plain - generalised, WHITENING_COST_POINTS)
        }
        MisfitEvidence::Misfit(found) => {
            let words = format!("{left}, and the residual {}", excess(&found).shown_by);
            (words, unexplained, UNEXPLAINED_PERCENT)
        }
        MisfitEvidence::Runs(found) => {
            let words = format!(
                "{left}, and gain, delay and offset differ from run to run by {:.0} % of it ({}): the runs are not \
                 of one servo under the same conditions, or it is not linear and their strokes are of other sizes",
                found.misfit_percent,
                probability(found.p)
            );
            (words, unexplained, UNEXPLAINED_PERCENT)
        }
        MisfitEvidence::MovesAgain(share) => {
            let percent = 100.0 * share;
            let words = format!(
                "the response to a step comes to rest, and moves again by {percent:.1} % of its end when the reference is changed next: the \
                 servo's answer depends on the size of the step, as with a limit of its speed, or on the step before, as with play, friction or a dead band, and equal \
                 holds make that look like a late part of the response"
            );
            (words, percent, MATERIAL_MISFIT_PERCENT)
        }
        MisfitEvidence::OutlastsHolds(holds) => {
            let words = format!(
                "a linear model of this recording responds for {holds:.2} holds of the reference, although the servo is seen to rest before each of them \
                 ends: its answer depends on the stroke before or on the size of the stroke, as with play, friction or a limit of its speed, and that \
                 looks like a late part of the response"
            );
            (words, holds, MARGIN)
        }
        MisfitEvidence::StatedBeyondHold(hold) => {
            let words = format!(
                "the servo is not linear, and the settling time of {settling} samples that was stated is longer than the usual hold of the reference, \
                 {hold} samples: how its answers to later steps differ passes for a late part of the response"
            );
            (words, settling as f64, hold as f64)
        }
        MisfitEvidence::NoSteps(found, seen) => {
            let Excess {
                percent, shown_by, ..
            } = excess(&found);
            let words = match has_noise {
                true => format!(
                    "errors of {percent:.1} % of the motion (rms) follow it, as those of a servo that is not linear do, and of a linear one that was not sent the noise \
                     in the column of its command; that noise hides whether steps are held until the servo has followed"
                ),
                false => format!(
                    "the servo is not linear ({percent:.1} % of the motion, rms, {shown_by}), and only {:.0} % of the steps of the reference are held until it has \
                     followed: its response to a step was not seen",
                    100.0 * seen
                ),
            };
            (words, seen, STEPS_FOLLOWED)
        }
    }
}

/// What of the motion noise does not explain.
struct Excess {
    /// Over all of it \[% rms\].
    percent: f64,
    /// Where it is large \[% rms\], as far as that is known: it is what has to matter.
    material_percent: f64,
    /// What shows it.
    shown_by: String,
}

/// The functions of the motion describe the errors more closely than the noise at rest does, so they come first.
fn excess(found: &Linearity) -> Excess {
    match found.against_rest().filter(|_| !found.by_functions()) {
        Some(rest) => Excess {
            percent: rest.misfit_percent,
            material_percent: rest.misfit_percent,
            shown_by: format!(
                "is {:.1} times the noise at rest ({})",
                rest.ratio,
                probability(rest.p)
            ),
        },
        None => Excess {
            percent: found.misfit_percent,
            material_percent: found.local_percent,
            shown_by: format!(
                "follows the motion in a way that neither noise nor a linear servo can ({}), {:.1} % where that is large",
                probability(found.p),
                found.local_percent
            ),
        },
    }
}

pub(super) fn not_linear(evidence: &Evidence<'_>) -> Option<Advice> {
    let linearity = evidence.explanation.linearity;
    let found = linearity.filter(|found| found.is_rejected() && evidence.misfit().is_none())?;
    let Excess {
        percent,
        material_percent,
        shown_by,
    } = excess(&found);
    let settling = evidence.explanation.settling.as_ref();
    let unsettled = settling.filter(|choice| !choice.settled && !evidence.has_bounds());
    let what = match unsettled {
        _ if evidence.explanation.command_noise.is_some() => {
            "The servo is not linear, or it was not sent the noise in the column of its command"
                .to_owned()
        }
        Some(choice) => format!(
            "The servo is not linear, or its response goes on beyond {:.3} s, the longest time that this recording shows",
            choice.longest as f64 * evidence.model.sample_period_s
        ),
        None => "The servo is not linear".to_owned(),
    };
    let consequence = match evidence.has_bounds() {
        true => {
            "The bounds are those of the linear description that fits this reference best: a single stroke may lie \
             outside, and other steps, amplitudes or a sine may give another description."
        }
        false => {
            "The response is that of the linear description that fits this reference best; other steps, amplitudes \
             or a sine may give another."
        }
    };
    Some(Advice::new(
        Check::Linearity,
        format!("{what}: {percent:.1} % of the motion (rms) {shown_by}. {consequence}"),
        material_percent,
        MATERIAL_MISFIT_PERCENT,
        format!(
            "Compare only what was recorded with the same reference; look at strokes up and down and at the \
             limits of speed and travel apart.{}{}",
            from_neutral(evidence),
            one_order(evidence)
        ),
    ))
}

/// That the first stroke of a run is not like the others.
fn from_neutral(evidence: &Evidence<'_>) -> &'static str {
    let runs = evidence.recorded.map_or(&[][..], |record| record.runs());
    match runs.iter().any(|run| leaves_neutral(run.input())) {
        true => {
            " The first stroke is not like the others, as it leaves a level for ever: where it is of another size, or a dead band is there, it is answered in another way. Begin a run at one of the other levels, or cut it off."
        }
        false => "",
    }
}

/// What several runs of one reference are worth of a servo that is not linear.
fn one_order(evidence: &Evidence<'_>) -> &'static str {
    match evidence.has_runs_of_one_order() {
        true => {
            " Give each run its levels in another order: what a linear model lacks repeats in runs of one order, and passes for a part of the response."
        }
        false => "",
    }
}

pub(super) fn metrics(evidence: &Evidence<'_>) -> Option<Advice> {
    let apart = evidence.misfit()?.disagreement(&evidence.model.step.value);
    (apart > DISAGREEMENT).then(|| {
        Advice::new(
            Check::Metrics,
            format!(
                "Delay, rise time, overshoot and the other metrics are left out: the step responses of plain and \
                 generalised least squares differ by up to {:.0} % of the largest value.",
                100.0 * apart.min(9.99)
            ),
            apart,
            DISAGREEMENT,
            "Record steps of one size that are held until the servo rests.",
        )
    })
}

/// Metrics that are relative to a gain that may be none.
pub(super) fn gain_may_be_zero(evidence: &Evidence<'_>) -> Option<Advice> {
    let metrics = &evidence.model.metrics;
    // The metrics have no gain without bounds.
    let gain = *evidence.model.step.value.last()?;
    let bounds = metrics.dc_gain.lower.zip(metrics.dc_gain.upper);
    let end_is_missing = matches!(
        evidence.validity.level,
        Bounds::Withdrawn(Reason::ResponseNotOver | Reason::EndUnseen)
    );
    let which = match bounds {
        Some((lower, upper)) => format!("whose bounds ({lower:.3} .. {upper:.3}) contain zero"),
        None if end_is_missing => {
            "which is not known where the end of the response is not seen".to_owned()
        }
        None => {
            "which the linear model does not determine: its errors are not noise, and by their size even a gain of zero is not excluded".to_owned()
        }
    };
    (metrics.withheld == Some(Withheld::GainMayBeZero)).then(|| {
        Advice::new(
            Check::GainMayBeZero,
            format!(
                "Delay, rise time, overshoot and the other metrics are left out: they are relative to the gain, {which}."
            ),
            gain,
            0.0,
            match evidence.model.linear && evidence.misfit().is_none() {
                true if end_is_missing => {
                    "Record holds of different lengths, in each of which the servo comes to rest.".to_owned()
                }
                true => "Record larger strokes, or more of them, each held until the servo rests.".to_owned(),
                false => evidence.slow_errors().map_or_else(
                    || {
                        "The servo is not linear, so take the servo model; for a linear one, record smaller strokes, each held until the \
                         servo rests."
                            .to_owned()
                    },
                    |slow| format!("{}. {}.", slow.in_words(), remedy_of_slow_errors(evidence)),
                ),
            },
        )
    })
}

pub(super) fn whiteness(evidence: &Evidence<'_>) -> Option<Advice> {
    // Errors that are not noise need no finding on the kind of noise.
    if evidence.misfit().is_some() {
        return None;
    }
    let order = evidence.model.structure.noise_order;
    let p = evidence.model.residuals.whiteness_p;
    let (check, finding, value, threshold) = match p.filter(|p| *p < RESIDUAL_SIGNIFICANCE) {
        Some(p) => {
            let effect = match evidence.has_bounds() {
                true => ", so the bounds are approximate",
                false => "",
            };
            let finding = format!(
                "The noise model is incomplete (order {order}): the one-step errors are related to each other{effect}."
            );
            (Check::Whiteness, finding, p, RESIDUAL_SIGNIFICANCE)
        }
        None if evidence.options.noise_order == NoiseOrder::Auto && order == MAX_AUTO_ORDER => {
            let finding = format!("The noise model has the highest order considered, {order}.");
            (
                Check::NoiseOrder,
                finding,
                order as f64,
                MAX_AUTO_ORDER as f64,
            )
        }
        None => return None,
    };
    let remedy = match runs_differ(evidence) {
        true => {
            "Runs that differ leave such errors by themselves: identify one run alone to see whether it has them."
        }
        false => {
            "Look for a periodic disturbance or a nonlinearity; a higher noise order may help."
        }
    };
    Some(Advice::new(check, finding, value, threshold, remedy))
}

pub(super) fn independence(evidence: &Evidence<'_>) -> Option<Advice> {
    let p = evidence.model.residuals.input_correlation_p;
    let p = p.filter(|p| *p < RESIDUAL_SIGNIFICANCE && evidence.misfit().is_none())?;
    let description = match evidence.has_bounds() {
        true => "the bounds are those of its best linear description only",
        false => "this is its best linear description only",
    };
    Some(Advice::new(
        Check::InputIndependence,
        "The residuals depend on the input: the response is longer than the settling time, has more detail than the \
         frequencies, or the servo is not linear. Of a linear servo, one or two recordings in a hundred show this by chance.",
        p,
        RESIDUAL_SIGNIFICANCE,
        format!(
            "Take a longer settling time or more frequencies; if neither helps, the servo is not linear and \
             {description}."
        ),
    ))
}

fn runs_differ(evidence: &Evidence<'_>) -> bool {
    let runs = evidence.explanation.runs.as_ref();
    runs.is_some_and(RunComparison::differ)
}

pub(super) fn slow_noise(evidence: &Evidence<'_>) -> Option<Advice> {
    // The errors of a servo that is not linear follow its motion, or its steps before, and those of runs that differ their commands: that looks like drift.
    let choice = evidence.explanation.settling.as_ref();
    let answers_before = choice.is_some_and(|choice| choice.moved_until.is_some());
    if evidence.errors_follow_motion() || answers_before || runs_differ(evidence) {
        return None;
    }
    let root = evidence.model.noise.largest_root();
    let (finding, value, threshold) = if root > SLOW_ROOT {
        let effect = match evidence.has_bounds() {
            true => "; the bounds of the gain rest on few independent stretches of it",
            false => "",
        };
        (format!("The noise drifts slowly{effect}."), root, SLOW_ROOT)
    } else {
        // Few steps leave few degrees of freedom at any noise.
        if evidence.model.noise.ar.is_empty() {
            return None;
        }
        let degrees = evidence.explanation.degrees_of_freedom.iter().flatten();
        let least = degrees.copied().fold(f64::INFINITY, f64::min);
        if least >= FEW_DEGREES {
            return None;
        }
        let uncertain = 100.0 / (2.0 * least).sqrt();
        let finding = format!(
            "The noise is slow: the width of the bounds is itself uncertain by {uncertain:.0} %."
        );
        (finding, least, FEW_DEGREES)
    };
    let remedy = "Record longer, or remove the drift at its source.";
    Some(Advice::new(
        Check::SlowNoise,
        finding,
        value,
        threshold,
        remedy,
    ))
}
