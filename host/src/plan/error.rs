//! Why there is no forecast of a run.

use super::request::PlanRequest;
use super::simulated_runs::simulated;
use crate::data::{Movement, hardly_moved};
use servoid_identification::Error;
use servoid_protocol::timing::SAMPLES_PER_FRAME;

/// Why there is no forecast of a run.
#[derive(Debug, thiserror::Error)]
pub enum PlanError {
    /// The servo stands still, and a recording of noise has nothing to identify.
    #[error(
        "the scatter of the assumed servo's position is {percent:.0} % of that of the command: friction, a dead band or a stop holds it at strokes as small as these; \
         raise --amplitude, or plan with another servo"
    )]
    HeldFast {
        /// The motion of its position as a share of that of the command (%).
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
    let mut movement = Movement::default();
    for run in record.runs().iter().take(1) {
        let (inputs, outputs) = (run.input(), run.output());
        let frames = inputs.chunks_exact(SAMPLES_PER_FRAME);
        let outputs = outputs.as_chunks::<SAMPLES_PER_FRAME>().0;
        for (command, positions) in frames.zip(outputs) {
            let command = command.first().copied().unwrap_or(f64::NAN);
            movement.take(command, *positions);
        }
    }
    match movement.share().filter(|share| hardly_moved(*share)) {
        Some(share) => Err(PlanError::HeldFast {
            percent: 100.0 * share,
        }),
        None => Ok(()),
    }
}
