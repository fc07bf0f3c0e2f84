//! Findings on the sensor: whether its steps are small enough for the noise.

use crate::diagnostics::advice::evidence::{Evidence, two_digits};
use crate::estimation::Excitation;
use crate::results::{Advice, Check};
use crate::thresholds::DITHERED;

const REMEDY: &str =
    "Use larger strokes, many different levels, or a sensor with smaller steps or more noise.";

pub(super) fn quantised(evidence: &Evidence<'_>) -> Option<Advice> {
    let found = evidence.explanation.resolution?;
    let smooth = evidence.explanation.excitation.as_ref();
    let steps = format!(
        "The sensor's steps of {} are larger than the noise",
        evidence.output(two_digits(found.step))
    );
    let (check, finding, remedy) = if smooth.is_some_and(Excitation::is_smooth) {
        // Under a smooth input the effect of rounding on the response grows with everything else.
        (
            Check::Rounding,
            format!(
                "{steps}, and the reference is smooth: the effect of the rounding on the response has no bound, so \
                 no bounds can be given."
            ),
            format!("Use a reference with sharp edges. {REMEDY}"),
        )
    } else {
        let gain = evidence.model.theta[0].abs();
        let allowance = found.allowance.map_or_else(String::new, |allowance| {
            // Of a servo that did not move any share of the gain is beyond all measure.
            if allowance >= gain {
                " The bounds contain more than the whole gain for it.".to_owned()
            } else {
                let percent = 100.0 * allowance / gain;
                format!(" The bounds contain {percent:.2} % of the gain for it.")
            }
        });
        (
            Check::Resolution,
            format!("{steps}: their rounding repeats itself and is not averaged out.{allowance}"),
            REMEDY.to_owned(),
        )
    };
    Some(Advice::new(
        check,
        finding,
        found.residual,
        DITHERED,
        remedy,
    ))
}
