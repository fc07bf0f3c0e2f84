//! Findings on the column of the command: whether it is what the servo was sent.

use crate::diagnostics::advice::evidence::{Evidence, two_digits};
use crate::results::{Advice, Check};
use crate::thresholds::NOISE_MATTERS;

/// Noise of a command that is held but for it.
pub(super) fn noise(evidence: &Evidence<'_>) -> Option<Advice> {
    let found = evidence.explanation.command_noise?;
    let effect = match (evidence.has_bounds(), found.shift) {
        (true, Some(shift)) if shift < NOISE_MATTERS => return None,
        (true, _) => {
            " Where the servo was not sent it, that makes the response too small and too slow; the bounds are wider by as much."
        }
        (false, _) => {
            " Where the servo was not sent it, that makes the response too small and too slow. Rests and strokes, which show stops and limits, are not looked for \
             in such a command."
        }
    };
    Some(Advice::new(
        Check::CommandNoise,
        format!(
            "The column of the command goes up and down within its holds, as noise does, with a standard deviation of {} at the most.{effect}",
            evidence.input(two_digits(found.sd))
        ),
        found.shift.unwrap_or_default(),
        NOISE_MATTERS,
        "Write each command as it was sent, not as it was measured. Where the servo was sent this noise, state that the column is exact.",
    ))
}
