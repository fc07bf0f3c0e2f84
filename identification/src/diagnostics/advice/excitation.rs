//! Findings on the input: whether it moves fast enough to tell the response.

use super::evidence::Evidence;
use crate::diagnostics::validity::unexcited_share;
use crate::results::{Advice, Check};
use crate::thresholds::DISAGREEMENT;

/// What cures all of it.
fn sharper(nyquist_hz: f64) -> String {
    format!(
        "Use a reference with sharp edges, such as a staircase or random steps without a filter before the \
         servo, which has power up to {nyquist_hz:.0} Hz."
    )
}

fn nyquist_hz(evidence: &Evidence<'_>) -> f64 {
    0.5 / evidence.model.sample_period_s
}

pub(super) fn excitation(evidence: &Evidence<'_>) -> Option<Advice> {
    let untold = evidence.explanation.unexcited_above_hz(evidence.model)?;
    let nyquist = nyquist_hz(evidence);
    Some(Advice::new(
        Check::Excitation,
        format!(
            "The reference has too little power from {untold:.1} Hz upwards to tell the response there, and a \
             step has much of its detail there. The bounds have no level; figures that rest on it are left out."
        ),
        untold,
        nyquist,
        sharper(nyquist),
    ))
}

/// An input that is smooth and tells all frequencies, at the price of wide bounds.
pub(super) fn smooth(evidence: &Evidence<'_>) -> Option<Advice> {
    let found = evidence.explanation.excitation?;
    if !found.is_smooth()
        || evidence
            .explanation
            .unexcited_above_hz(evidence.model)
            .is_some()
    {
        return None;
    }
    let nyquist = nyquist_hz(evidence);
    Some(Advice::new(
        Check::SmoothReference,
        format!(
            "The reference is smooth: it has little power above {:.0} Hz, which makes the bounds of the step \
             response wide.",
            found.power_up_to_hz
        ),
        found.power_up_to_hz,
        nyquist,
        sharper(nyquist),
    ))
}

/// Metrics that were left out because they rest on frequencies that the input does not excite.
pub(super) fn metrics(evidence: &Evidence<'_>) -> Option<Advice> {
    let share = unexcited_share(evidence.explanation, evidence.model)?;
    (share > DISAGREEMENT).then(|| {
        Advice::new(
            Check::UnexcitedMetrics,
            format!(
                "Gain, delay, bandwidth and the like are left out: the frequencies that the reference does not \
                 excite may change the step response by {:.0} % of its final value.",
                100.0 * share.min(9.99)
            ),
            share,
            DISAGREEMENT,
            sharper(nyquist_hz(evidence)),
        )
    })
}
