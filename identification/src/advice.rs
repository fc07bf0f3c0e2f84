//! Findings with their numbers, and what to do about each.

use serde::{Deserialize, Serialize};

use crate::explanation::Explanation;
use crate::gls::MAX_AUTO_ORDER;
use crate::identify::WELL_CONDITIONED;
use crate::linearity::{self, Linearity};
use crate::model::{Model, SelectedBy};
use crate::model_error::{DISAGREEMENT, ModelErrors, SEEN, Sign, TOLERATED, UNEXPLAINED};
use crate::noise::largest_root;
use crate::normal::Path;
use crate::options::{Frequencies, NoiseOrder, Options};
use crate::structure::{Choice, DETECTION, MARGIN};

/// One finding.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Advice {
    /// Short name of the check, stable between versions, such as `settled`.
    pub check: String,
    /// What was found, as one sentence.
    pub finding: String,
    /// The number that was found.
    pub value: f64,
    /// The number it was held against.
    pub threshold: f64,
    /// What to do, as one sentence.
    #[serde(rename = "do")]
    pub remedy: String,
}

impl Advice {
    /// A finding; numbers beyond the finite ones are brought to the largest finite ones, because
    /// the document that carries them has no infinity.
    #[must_use]
    pub fn new(
        check: &str,
        finding: String,
        value: f64,
        threshold: f64,
        remedy: impl Into<String>,
    ) -> Self {
        let finite = |x: f64| {
            if x.is_nan() {
                0.0
            } else {
                x.clamp(f64::MIN, f64::MAX)
            }
        };
        Self {
            check: check.to_owned(),
            finding,
            value: finite(value),
            threshold: finite(threshold),
            remedy: remedy.into(),
        }
    }
}

/// What advice is drawn from.
pub(crate) struct Evidence<'a> {
    pub(crate) model: &'a Model,
    pub(crate) explanation: &'a Explanation,
    pub(crate) options: &'a Options,
    /// Samples of the record, missing ones included.
    pub(crate) samples: usize,
}

/// p-values below this are findings.
const SIGNIFICANCE: f64 = 0.01;

/// Fewer degrees of freedom than this make the width of a band itself uncertain.
const FEW_DEGREES: f64 = 30.0;

/// A root of D(z) beyond this is drift.
const SLOW_ROOT: f64 = 0.98;

/// More parameters than this share of the rows leave too little to judge the noise by.
const LARGE_SHARE: f64 = 0.25;

/// All findings on a model.
pub(crate) fn gather(evidence: &Evidence<'_>) -> Vec<Advice> {
    [
        model_error(evidence),
        not_linear(evidence),
        excitation(evidence),
        figures(evidence),
        settled(evidence),
        repeats(evidence),
        hidden_tail(evidence),
        responds(evidence),
        truncated(evidence),
        parameters(evidence),
        slow_noise(evidence),
        whiteness(evidence),
        independence(evidence),
        conditioning(evidence),
        converged(evidence),
        scatter(evidence),
        deviating(evidence),
        history(evidence),
    ]
    .into_iter()
    .flatten()
    .collect()
}

/// The choice of the settling time, unless it was overruled because the errors are not noise.
fn trusted_choice<'a>(evidence: &Evidence<'a>) -> Option<&'a Choice> {
    let explanation = evidence.explanation;
    explanation
        .settling
        .as_ref()
        .filter(|_| explanation.model_errors.is_none())
}

fn settled(evidence: &Evidence<'_>) -> Option<Advice> {
    let choice = trusted_choice(evidence).filter(|choice| !choice.settled)?;
    let period = evidence.model.sample_period_s;
    let longest = choice.longest as f64 * period;
    let moving = choice.detected as f64 * period;
    Some(Advice::new(
        "settled",
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

fn repeats(evidence: &Evidence<'_>) -> Option<Advice> {
    let settling = evidence.explanation.settling.as_ref()?;
    let repeats = settling.repeats_after? as f64 * evidence.model.sample_period_s;
    Some(Advice::new(
        "repeats",
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
fn hidden_tail(evidence: &Evidence<'_>) -> Option<Advice> {
    trusted_choice(evidence).filter(|choice| choice.settled && choice.detected > 1)?;
    let step = &evidence.model.step;
    let size = step.value.last()?.abs();
    let sd = step.sd.iter().copied().fold(0.0, f64::max);
    let hidden = DETECTION * (DETECTION * sd / size).powf(MARGIN - 1.0);
    (hidden > HIDDEN).then(|| {
        Advice::new(
            "hidden_tail",
            format!(
                "The noise is large: a slow end or a ringing of the response below {:.0} % of the final \
                 value cannot be seen, and what is left of it after the settling time may be {hidden:.1} \
                 standard deviations. The bounds may hold less often than they say.",
                100.0 * DETECTION * sd / size
            ),
            hidden,
            HIDDEN,
            "Record longer, or use larger steps.",
        )
    })
}

fn responds(evidence: &Evidence<'_>) -> Option<Advice> {
    let choice = trusted_choice(evidence).filter(|choice| choice.detected <= 1)?;
    Some(Advice::new(
        "response",
        "The output shows no response to the input above the noise.".to_owned(),
        choice.detected as f64,
        1.0,
        "Check that input and output belong together, and use larger steps.",
    ))
}

fn truncated(evidence: &Evidence<'_>) -> Option<Advice> {
    let model = evidence.model;
    let basis = model.basis().ok()?;
    if basis.has_all_frequencies() {
        return None;
    }
    let bias = model.step.truncation_bias;
    let noise = model.step.mean_half_widths().0 - bias;
    let highest = basis.highest_hz(model.sample_period_s);
    let decade = if model.structure.selected_by == SelectedBy::Narrow {
        40
    } else {
        20
    };
    let automatic = evidence.options.frequencies == Frequencies::Auto;
    let errors = evidence.explanation.model_errors.as_ref();
    // The choice for prediction leaves out what does not help it, whether the input has it or not.
    let low_passed = errors.is_none_or(|errors| errors.untold_from_hz.is_some());
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
            format!(
                "The input has too little power above {highest:.1} Hz to tell the response there"
            ),
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
    Some(Advice::new(
        "truncation",
        format!(
            "{finding}. The bands contain {bias:.2e} for what is left out, which holds if the response \
             falls by at least {decade} dB/decade above."
        ),
        bias,
        noise,
        remedy,
    ))
}

fn parameters(evidence: &Evidence<'_>) -> Option<Advice> {
    let rows = evidence.explanation.rows as f64;
    let share = (evidence.model.theta.len() + 1) as f64 / rows;
    (share > LARGE_SHARE).then(|| {
        Advice::new(
            "parameters",
            format!(
                "The model has a parameter for every {:.1} samples.",
                1.0 / share
            ),
            share,
            LARGE_SHARE,
            "Record longer, or ask for a shorter settling time.",
        )
    })
}

fn slow_noise(evidence: &Evidence<'_>) -> Option<Advice> {
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
            "slow_noise",
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
        Advice::new("slow_noise", finding, degrees, FEW_DEGREES, remedy)
    })
}

fn whiteness(evidence: &Evidence<'_>) -> Option<Advice> {
    let order = evidence.model.structure.noise_order;
    let remedy =
        "Look for a periodic disturbance or a nonlinearity; a higher noise order may help.";
    if let Some(p) = evidence
        .model
        .residuals
        .whiteness_p
        .filter(|p| *p < SIGNIFICANCE)
    {
        let finding = format!(
            "The noise model is incomplete (order {order}): the one-step errors are related to each \
             other, so the bounds are approximate."
        );
        return Some(Advice::new("whiteness", finding, p, SIGNIFICANCE, remedy));
    }
    (evidence.options.noise_order == NoiseOrder::Auto && order == MAX_AUTO_ORDER).then(|| {
        let finding = format!("The noise model has the highest order considered, {order}.");
        Advice::new(
            "noise_order",
            finding,
            order as f64,
            MAX_AUTO_ORDER as f64,
            remedy,
        )
    })
}

fn independence(evidence: &Evidence<'_>) -> Option<Advice> {
    let p = evidence
        .model
        .residuals
        .input_correlation_p
        .filter(|p| *p < SIGNIFICANCE)?;
    Some(Advice::new(
        "input_independence",
        "What the model leaves over still depends on the input: the response is longer than the \
         settling time, has more detail than the frequencies, or the servo is not linear."
            .to_owned(),
        p,
        SIGNIFICANCE,
        "Take a longer settling time or more frequencies; if neither helps, the servo is not linear \
         and the bounds describe its best linear picture only.",
    ))
}

fn conditioning(evidence: &Evidence<'_>) -> Option<Advice> {
    (evidence.explanation.path == Path::Qr).then(|| {
        Advice::new(
            "conditioning",
            "The moments were not accurate enough for this input or this little noise; the rows \
             were factorised by QR instead, which is slower and as accurate as ever."
                .to_owned(),
            evidence.explanation.condition,
            WELL_CONDITIONED,
            "Nothing needs to be done; sharper edges in the input make the moments suffice.",
        )
    })
}

fn converged(evidence: &Evidence<'_>) -> Option<Advice> {
    (!evidence.model.converged).then(|| {
        Advice::new(
            "converged",
            "The noise model did not come to rest.".to_owned(),
            evidence.model.iterations as f64,
            evidence.model.iterations as f64,
            "Fix the noise order, or look for a disturbance that comes and goes.",
        )
    })
}

/// The check of errors that are not noise: while it is among the advice, bounds have no level.
pub const MODEL_ERROR: &str = "model_error";

fn model_error(evidence: &Evidence<'_>) -> Option<Advice> {
    let errors = evidence.explanation.model_errors.as_ref()?;
    let level = 100.0 * evidence.options.level;
    let taken = if evidence.model.structure.noise_order == 0 {
        "plain"
    } else {
        "generalised"
    };
    // With a smooth input, what the left-out frequencies do to the others looks the same.
    let smooth = match errors.untold_from_hz {
        Some(_) => " The input is too smooth to tell whether the servo or the input is the reason.",
        None => "",
    };
    let (sign, value, threshold) = sign_in_words(errors);
    Some(Advice::new(
        MODEL_ERROR,
        format!(
            "What the model cannot explain is not noise: {sign}. The bounds are not {level} % bounds of \
             anything. The structure was chosen by how well it predicts parts not seen, and {taken} \
             least squares was taken.{smooth}"
        ),
        value,
        threshold,
        "Record steps that are held until the servo rests, smaller ones and fewer a second; use this \
         model for prediction, not for comparison by its bounds.",
    ))
}

/// What told that errors are not noise, the number and what it was held against.
fn sign_in_words(errors: &ModelErrors) -> (String, f64, f64) {
    match errors.sign {
        Sign::Whitening => {
            let (plain, generalised) = (errors.least_squares_percent, errors.generalised_percent);
            let words = format!(
                "generalised least squares simulates the record to {generalised:.1} %, plain least squares \
                 to {plain:.1} %"
            );
            (words, plain - generalised, TOLERATED)
        }
        Sign::Misfit(found) => {
            let left = 100.0 - errors.least_squares_percent.max(errors.generalised_percent);
            let words = format!(
                "simulation leaves {left:.0} % of the motion (rms), and what it leaves follows the motion, which \
                 noise does not (p = {:.1e})",
                found.p
            );
            (words, left, UNEXPLAINED)
        }
        Sign::NoSteps(found, seen) => {
            let words = format!(
                "the servo is not linear ({:.1} % of the motion, rms, p = {:.1e}), and of the steps of the \
                 reference {:.0} % are held until it has followed: how it answers a step was not seen",
                found.misfit_percent,
                found.p,
                100.0 * seen
            );
            (words, seen, SEEN)
        }
    }
}

/// The check of a servo that is not linear, by little enough for bounds of its best linear
/// description to have their level.
pub const NOT_LINEAR: &str = "linearity";

fn not_linear(evidence: &Evidence<'_>) -> Option<Advice> {
    let found = evidence
        .explanation
        .linearity
        .filter(Linearity::is_rejected)?;
    if evidence.explanation.model_errors.is_some() {
        return None;
    }
    Some(Advice::new(
        NOT_LINEAR,
        format!(
            "The servo is not linear: {:.1} % of the motion (rms) follows it in a way that no linear servo \
             can (p = {:.1e}). The bounds are those of the linear description that fits this reference \
             best: a single stroke may lie outside, and other steps, amplitudes or a sine may give \
             another description.",
            found.misfit_percent, found.p
        ),
        found.misfit_percent,
        linearity::WORTH_MENTIONING,
        "Compare only what was recorded with the same reference; look at strokes up and down and at the \
         limits of speed and travel apart (--limits).",
    ))
}

fn excitation(evidence: &Evidence<'_>) -> Option<Advice> {
    let errors = evidence.explanation.model_errors.as_ref()?;
    let untold = errors.untold_from_hz?;
    let asked = 0.5 / evidence.model.sample_period_s;
    Some(Advice::new(
        "excitation",
        format!(
            "The input is smooth: from {untold:.1} Hz upwards it has too little power to tell the \
             response, and a step has much of its detail there."
        ),
        untold,
        asked,
        format!(
            "Use a reference with sharp edges, such as a staircase or random steps, which has power up \
             to {asked:.0} Hz."
        ),
    ))
}

fn figures(evidence: &Evidence<'_>) -> Option<Advice> {
    let errors = evidence.explanation.model_errors.as_ref()?;
    let apart = errors.disagreement(&evidence.model.step.value);
    (apart > DISAGREEMENT).then(|| {
        Advice::new(
            "metrics",
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

fn scatter(evidence: &Evidence<'_>) -> Option<Advice> {
    let runs = evidence.explanation.runs.as_ref()?;
    let p = [runs.gain_percent, runs.delay_s, runs.offset]
        .iter()
        .map(|s| s.p)
        .fold(1.0, f64::min);
    // Three numbers are tested.
    let threshold = SIGNIFICANCE / 3.0;
    (p < threshold).then(|| {
        Advice::new(
            "run_scatter",
            format!(
                "The runs differ by more than their noise: gain by {:.2} %, delay by {:.2} ms, offset \
                 by {:.3} (standard deviations between runs). The bounds hold for the mean of these \
                 runs, not for the next one.",
                runs.gain_percent.sd,
                1000.0 * runs.delay_s.sd,
                runs.offset.sd
            ),
            p,
            threshold,
            "Look for what changes from run to run, such as supply voltage or temperature; compare \
             servos by several runs each.",
        )
    })
}

fn deviating(evidence: &Evidence<'_>) -> Option<Advice> {
    let runs = evidence.explanation.runs.as_ref()?;
    let deviating = runs.deviating?;
    let run = runs.runs.iter().find(|run| run.run == deviating.run)?;
    Some(Advice::new(
        "deviating_run",
        format!(
            "Run {} stands out from the others: gain {:+.2} %, delay {:+.2} ms, offset {:+.3} against \
             the common model.",
            run.run,
            run.gain_percent.value,
            1000.0 * run.delay_s.value,
            run.offset.value
        ),
        deviating.distance,
        deviating.threshold,
        format!(
            "Look at run {} before using it; identify again without it and compare.",
            run.run
        ),
    ))
}

/// Share of the samples that may be lost to history without a word.
const LOST_TO_HISTORY: f64 = 0.2;

fn history(evidence: &Evidence<'_>) -> Option<Advice> {
    let fit = &evidence.model.fit;
    let present = (evidence.samples - fit.samples_missing) as f64;
    let lost = 1.0 - evidence.explanation.rows as f64 / present;
    (lost > LOST_TO_HISTORY).then(|| {
        Advice::new(
            "history",
            format!(
                "{:.0} % of the samples only serve as history of others, because each run begins \
                 with an unknown past.",
                100.0 * lost
            ),
            lost,
            LOST_TO_HISTORY,
            "State the input before the runs (at rest), if it is known; or record fewer and longer \
             runs.",
        )
    })
}
