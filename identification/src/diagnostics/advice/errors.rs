//! Findings on the errors: whether they are noise, and noise of the kind that the model says.

use super::evidence::Evidence;
use crate::diagnostics::linearity::Linearity;
use crate::diagnostics::misfit::{Misfit, MisfitEvidence};
use crate::estimation::largest_root;
use crate::options::{MAX_AUTO_ORDER, NoiseOrder};
use crate::results::{Advice, Check};
use crate::thresholds::{
    DISAGREEMENT, MATERIAL_MISFIT_PERCENT, RESIDUAL_SIGNIFICANCE, STEPS_FOLLOWED,
    UNEXPLAINED_PERCENT, WHITENING_COST_POINTS,
};

pub(super) fn model_error(evidence: &Evidence<'_>) -> Option<Advice> {
    let errors = evidence.explanation.model_errors.as_ref()?;
    let taken = if evidence.model.structure.noise_order == 0 {
        "plain"
    } else {
        "generalised"
    };
    // With a smooth input, what the left-out frequencies do to the others looks the same.
    let smooth = match errors.unexcited_above_hz {
        Some(_) => " The input is too smooth to tell whether the servo or the input is the reason.",
        None => "",
    };
    let chosen_by = match errors.candidates.is_empty() {
        true => "how well it simulates this record, as no part of it tells of another",
        false => "how well it predicts parts not seen",
    };
    let worth = match errors.candidates.first() {
        Some(best) => format!(
            "use this model for prediction (it met parts not seen to {:.0} %), not for comparison",
            best.cross_validated_percent
        ),
        None => "use this model as a picture of this recording alone".to_owned(),
    };
    let (sign, value, threshold) = sign_in_words(errors);
    Some(Advice::new(
        Check::ModelError,
        format!(
            "What the model cannot explain is not noise: {sign}. So no bounds can be given. The structure was chosen by {chosen_by}, and {taken} \
             least squares was taken.{smooth}"
        ),
        value,
        threshold,
        format!(
            "Record steps that are held until the servo rests, smaller ones and fewer a second; {worth}."
        ),
    ))
}

/// "p = 2.3e-7"; smaller ones than any table has are not told apart.
fn probability(p: f64) -> String {
    const LEAST: f64 = 1e-12;
    if p < LEAST {
        format!("p < {LEAST:.0e}")
    } else {
        format!("p = {p:.1e}")
    }
}

/// What told that errors are not noise, the number and what it was held against.
fn sign_in_words(errors: &Misfit) -> (String, f64, f64) {
    match errors.evidence {
        MisfitEvidence::Whitening => {
            let (plain, generalised) = (errors.least_squares_percent, errors.generalised_percent);
            let simulated = |percent: f64| match percent > 0.0 {
                true => format!("to {percent:.1} %"),
                false => "worse than its mean does".to_owned(),
            };
            let words = format!(
                "generalised least squares simulates the record {}, plain least squares {}",
                simulated(generalised),
                simulated(plain)
            );
            (words, plain - generalised, WHITENING_COST_POINTS)
        }
        MisfitEvidence::Misfit(found) => {
            let left = errors.unexplained_percent();
            let words = format!(
                "simulation leaves {left:.0} % of the motion (rms), and what it leaves {}",
                Shown::by(&found).how
            );
            (words, left, UNEXPLAINED_PERCENT)
        }
        MisfitEvidence::Runs(found) => {
            let left = errors.unexplained_percent();
            let words = format!(
                "simulation leaves {left:.0} % of the motion (rms), and gain, delay and offset differ from run to \
                 run by {:.0} % of it ({}): the runs are not of one servo under the same conditions",
                found.misfit_percent,
                probability(found.p)
            );
            (words, left, UNEXPLAINED_PERCENT)
        }
        MisfitEvidence::NoSteps(found, seen) => {
            let shown = Shown::by(&found);
            let words = format!(
                "the servo is not linear ({:.1} % of the motion, rms, {}), and of the steps of the \
                 reference {:.0} % are held until it has followed: how it answers a step was not seen",
                shown.percent,
                shown.how,
                100.0 * seen
            );
            (words, seen, STEPS_FOLLOWED)
        }
    }
}

/// What showed that errors are not noise.
struct Shown {
    /// How much of the motion is concerned \[% rms\].
    percent: f64,
    /// What the errors do.
    how: String,
}

impl Shown {
    /// The functions of the motion know what the errors are like, so they come first.
    fn by(found: &Linearity) -> Self {
        match found.against_rest().filter(|_| !found.by_functions()) {
            Some(rest) => Self {
                percent: rest.misfit_percent,
                how: format!(
                    "is {:.1} times the noise at rest ({})",
                    rest.ratio,
                    probability(rest.p)
                ),
            },
            None => Self {
                percent: found.misfit_percent,
                how: format!(
                    "follows the motion in a way that neither noise nor a linear servo can ({})",
                    probability(found.p)
                ),
            },
        }
    }
}

pub(super) fn not_linear(evidence: &Evidence<'_>) -> Option<Advice> {
    let found = evidence
        .explanation
        .linearity
        .filter(Linearity::is_rejected)?;
    if evidence.explanation.model_errors.is_some() {
        return None;
    }
    let shown = Shown::by(&found);
    Some(Advice::new(
        Check::Linearity,
        format!(
            "The servo is not linear: {:.1} % of the motion (rms) {}. The bounds are those of the linear \
             description that fits this reference best: a single stroke may lie outside, and other steps, \
             amplitudes or a sine may give another description.",
            shown.percent, shown.how
        ),
        shown.percent,
        MATERIAL_MISFIT_PERCENT,
        "Compare only what was recorded with the same reference; look at strokes up and down and at the \
         limits of speed and travel apart (--limits).",
    ))
}

/// Whether errors are shown to be more than noise, so that they say nothing of how large noise is.
pub(super) fn nonlinear(evidence: &Evidence<'_>) -> bool {
    let linearity = evidence.explanation.linearity.as_ref();
    evidence.explanation.model_errors.is_some()
        || linearity.is_some_and(Linearity::errors_follow_motion)
}

pub(super) fn metrics(evidence: &Evidence<'_>) -> Option<Advice> {
    let errors = evidence.explanation.model_errors.as_ref()?;
    let apart = errors.disagreement(&evidence.model.step.value);
    (apart > DISAGREEMENT).then(|| {
        Advice::new(
            Check::Metrics,
            format!(
                "Delay, rise time, overshoot and the like cannot be told from this recording: the step \
                 responses of plain and generalised least squares differ by up to {:.0} % of the largest \
                 value. They are left out.",
                100.0 * apart.min(9.99)
            ),
            apart,
            DISAGREEMENT,
            "Record steps that are held until the servo rests.",
        )
    })
}

pub(super) fn whiteness(evidence: &Evidence<'_>) -> Option<Advice> {
    // Of errors that are not noise, nothing more is to be said of the kind of noise.
    if evidence.explanation.model_errors.is_some() {
        return None;
    }
    let order = evidence.model.structure.noise_order;
    let remedy =
        "Look for a periodic disturbance or a nonlinearity; a higher noise order may help.";
    if let Some(p) = evidence
        .model
        .residuals
        .whiteness_p
        .filter(|p| *p < RESIDUAL_SIGNIFICANCE)
    {
        let finding = format!(
            "The noise model is incomplete (order {order}): the one-step errors are related to each \
             other, so the bounds are approximate."
        );
        return Some(Advice::new(
            Check::Whiteness,
            finding,
            p,
            RESIDUAL_SIGNIFICANCE,
            remedy,
        ));
    }
    (evidence.options.noise_order == NoiseOrder::Auto && order == MAX_AUTO_ORDER).then(|| {
        let finding = format!("The noise model has the highest order considered, {order}.");
        Advice::new(
            Check::NoiseOrder,
            finding,
            order as f64,
            MAX_AUTO_ORDER as f64,
            remedy,
        )
    })
}

pub(super) fn independence(evidence: &Evidence<'_>) -> Option<Advice> {
    if evidence.explanation.model_errors.is_some() {
        return None;
    }
    let p = evidence
        .model
        .residuals
        .input_correlation_p
        .filter(|p| *p < RESIDUAL_SIGNIFICANCE)?;
    Some(Advice::new(
        Check::InputIndependence,
        "What the model leaves over still depends on the input: the response is longer than the \
         settling time, has more detail than the frequencies, or the servo is not linear."
            .to_owned(),
        p,
        RESIDUAL_SIGNIFICANCE,
        "Take a longer settling time or more frequencies; if neither helps, the servo is not linear \
         and the bounds describe its best linear picture only.",
    ))
}

/// A root of D(z) beyond this is drift.
const SLOW_ROOT: f64 = 0.98;

/// Fewer degrees of freedom than this make the width of a band itself uncertain.
const FEW_DEGREES: f64 = 30.0;

pub(super) fn slow_noise(evidence: &Evidence<'_>) -> Option<Advice> {
    // Of a servo that is not linear, what seems to drift is the rest of its motion.
    if nonlinear(evidence) {
        return None;
    }
    let degrees = evidence
        .explanation
        .degrees_of_freedom
        .iter()
        .copied()
        .fold(f64::INFINITY, f64::min);
    let root = largest_root(&evidence.model.noise.ar);
    let remedy = "Record longer, or remove the drift at its source.";
    if root > SLOW_ROOT {
        let finding = "The noise drifts slowly; the bounds of the gain rest on few independent \
                       stretches of it.";
        return Some(Advice::new(
            Check::SlowNoise,
            finding.to_owned(),
            root,
            SLOW_ROOT,
            remedy,
        ));
    }
    (degrees < FEW_DEGREES).then(|| {
        let uncertain = 100.0 / (2.0 * degrees).sqrt();
        let finding = format!(
            "The noise is slow: the width of the bands is itself uncertain by {uncertain:.0} %."
        );
        Advice::new(Check::SlowNoise, finding, degrees, FEW_DEGREES, remedy)
    })
}
