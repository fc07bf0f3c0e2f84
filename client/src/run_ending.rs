//! How a run ended, and whether all of it arrived.

use crate::frame_order::FrameOrder;
use servoid_protocol::message::{EndReason, Ended};

/// A run that was followed to its end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RunEnding {
    /// Why the rig ended it.
    pub reason: EndReason,
    /// Whether its frames are here.
    pub arrived: Arrived,
}

/// Which frames of a run arrived.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Arrived {
    /// All of them, and the rig's check over the run agrees.
    Whole,
    /// All that the board caught; the others it lost itself.
    LostOnBoard,
    /// Some were lost on the line, and the board no longer had them when they were asked for again.
    LostOnLine,
    /// As many as there were, and the rig's check differs: they are not to be trusted.
    CheckDiffers,
}

impl RunEnding {
    /// The end of a run whose frames have all been released or given up.
    pub(crate) fn of(ended: &Ended, order: &FrameOrder) -> Self {
        let arrived = if order.lacks_only_what_the_board_lost(ended) {
            match ended.frames_lost_on_board {
                0 => Arrived::Whole,
                _ => Arrived::LostOnBoard,
            }
        } else if order.given_up() == 0 {
            Arrived::CheckDiffers
        } else {
            Arrived::LostOnLine
        };
        Self {
            reason: ended.reason,
            arrived,
        }
    }
}
