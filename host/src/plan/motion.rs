//! Whether the assumed servo moves under the planned strokes.

use super::error::PlanError;
use super::request::PlanRequest;
use super::simulated_runs::simulated;
use crate::data::{Movement, hardly_moved};
use servoid_protocol::timing::SAMPLES_PER_FRAME;

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
