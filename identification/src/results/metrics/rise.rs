//! The rise of a step response.

use super::interval::Interval;

/// Intervals of the crossings of the rise and of the time between two of them, in samples.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RiseIntervals {
    pub(crate) delay: Interval,
    pub(crate) half: Interval,
    pub(crate) rise: Interval,
}
