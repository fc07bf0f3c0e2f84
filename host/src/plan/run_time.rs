//! Duration of a run.

use crate::instrument::reference::seconds;
use crate::instrument::rig::ROLL_FRAMES;
use servoid_protocol::Reference;

/// Duration of one run: the reference, and the rest before and after it (s).
pub(super) fn run_s(reference: &Reference) -> f64 {
    seconds(reference.frames() + 2 * u32::from(ROLL_FRAMES))
}
