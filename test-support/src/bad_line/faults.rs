//! How bad a line is.

use servoid_protocol::timing::FRAME_US;
use std::time::Duration;

/// The probability of each fate of a frame in one direction.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Faults {
    /// It is lost.
    pub lost: f64,
    /// It is corrupted.
    pub corrupted: f64,
    /// It comes twice.
    pub duplicated: f64,
    /// It is late by up to [`LATEST`]; those after it are not, unless chance wants it of each.
    pub reordered: f64,
    /// A burst begins with it: from 2 to [`LONGEST_BURST`] frames, as far as they set out within what
    /// it is late by, up to [`LATEST`]. They arrive together, in a mixed order.
    pub burst: f64,
    /// The line stands still for up to [`LONGEST_STALL`].
    pub stalled: f64,
}

/// The latest that a reordered frame or a duplicate comes.
pub const LATEST: Duration = Duration::from_millis(500);

/// The most frames in a burst: those of a run that set out within the longest time that a burst is
/// late by.
pub const LONGEST_BURST: u32 = (LATEST.as_micros() / FRAME_US as u128) as u32;

/// The longest that the line stands still.
pub const LONGEST_STALL: Duration = Duration::from_millis(700);

impl Faults {
    /// A line that loses this share of the frames and corrupts the same share, with every other
    /// kind of trouble thrown in. What hits many frames at a time, begins with one in ten of those.
    #[must_use]
    pub fn of_rate(rate: f64) -> Self {
        Self {
            lost: rate,
            corrupted: rate,
            duplicated: rate,
            reordered: rate,
            burst: rate / 10.0,
            stalled: rate / 10.0,
        }
    }
}
