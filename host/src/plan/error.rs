//! Why there is no forecast of a run.

use servoid_identification::Error;

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
