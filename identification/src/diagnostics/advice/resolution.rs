//! Findings on the sensor: whether its steps are small enough for the noise.

use super::evidence::Evidence;
use crate::results::{Advice, Check};
use crate::thresholds::DITHERED;

const REMEDY: &str =
    "Use larger strokes, many different levels, or a sensor with smaller steps or more noise.";

/// Rounding that the bounds contain.
pub(super) fn coarse(evidence: &Evidence<'_>) -> Option<Advice> {
    let found = evidence.explanation.resolution?;
    if is_smooth(evidence) {
        return None;
    }
    let percent = match evidence.model.theta[0].abs() {
        gain if gain > 0.0 => 100.0 * found.allowance / gain,
        _ => 0.0,
    };
    Some(Advice::new(
        Check::Resolution,
        format!(
            "The sensor's steps of {} are larger than the noise: its rounding repeats itself and is not \
             averaged out. The bounds contain {percent:.2} % of the gain for it.",
            step_in_words(found.step)
        ),
        found.residual,
        DITHERED,
        REMEDY,
    ))
}

/// Under a smooth input what rounding does to the response grows with everything else, and nothing bounds it.
pub(super) fn rounding(evidence: &Evidence<'_>) -> Option<Advice> {
    let found = evidence.explanation.resolution?;
    is_smooth(evidence).then(|| {
        Advice::new(
            Check::Rounding,
            format!(
                "The sensor's steps of {} are larger than the noise, and the reference is smooth: what the \
                 rounding does to the response is not known. The bounds have no level.",
                step_in_words(found.step)
            ),
            found.residual,
            DITHERED,
            format!("Use a reference with sharp edges. {REMEDY}"),
        )
    })
}

fn is_smooth(evidence: &Evidence<'_>) -> bool {
    evidence
        .explanation
        .excitation
        .is_some_and(|found| found.is_smooth())
}

/// Two digits that count.
fn step_in_words(step: f64) -> String {
    let digits = (1.0 - step.log10().floor()).clamp(0.0, 9.0) as usize;
    format!("{step:.digits$}")
}
