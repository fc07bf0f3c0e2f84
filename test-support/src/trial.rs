//! A recording with what identification should find in it.

use servoid_identification::Record;

/// One recording of a servo whose response to a step is known.
pub struct Trial {
    pub record: Record<'static>,
    /// The exact response to a unit step from sample 0 on, longer than any N.
    pub truth: Vec<f64>,
}
