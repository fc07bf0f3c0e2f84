//! Why there is no forecast of a run.

use super::request::PlanRequest;
use super::simulated_runs::simulated;
use crate::data::{Following, hardly_moved};
use servoid_identification::Error;
use servoid_protocol::timing::SAMPLES_PER_FRAME;

/// Why there is no forecast of a run.
#[derive(Debug, thiserror::Error)]
pub enum PlanError {
    /// The servo stands still, and a recording of noise has nothing to identify.
    #[error(
        "the assumed servo follows the command by {percent:.0} % only: friction, a dead band or a stop holds it at strokes as small as these; \
         raise --amplitude, or plan with another servo"
    )]
    HeldFast {
        /// The share of the command by which it follows (%).
        percent: f64,
    },
    /// The run cannot be identified.
    #[error(transparent)]
    Identification(#[from] Error),
}

/// That the assumed servo moves under this reference. Of one that is known by its linear model alone nothing else is known.
pub(super) fn require_motion(request: &PlanRequest) -> Result<(), PlanError> {
    if request.assumed.simulation.is_none() {
        return Ok(());
    }
    let record = simulated(request, 1)?;
    let mut following = Following::default();
    for run in record.runs().iter().take(1) {
        let (inputs, outputs) = (run.input(), run.output());
        let frames = inputs.chunks_exact(SAMPLES_PER_FRAME);
        let outputs = outputs.as_chunks::<SAMPLES_PER_FRAME>().0;
        for ((number, command), positions) in (0..).zip(frames).zip(outputs) {
            let command = command.first().copied().unwrap_or(f64::NAN);
            following.take(number, command, *positions);
        }
    }
    match following.share().filter(|share| hardly_moved(*share)) {
        Some(share) => Err(PlanError::HeldFast {
            percent: 100.0 * share,
        }),
        None => Ok(()),
    }
}
