//! The highest frequency that a reference can carry.

use crate::timing::FRAMES_PER_SECOND;

/// Half the frame rate (mHz): what changes once per frame can carry no higher frequency.
pub const HIGHEST_MILLIHERTZ: u16 = (FRAMES_PER_SECOND * 1_000 / 2) as u16;
