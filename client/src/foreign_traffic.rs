//! Runs of other programs, heard on the line.

use crate::error::ClientError;
use crate::line::Line;
use crate::request::Answer;
use crate::session::Opening;
use crate::task::{Next, Task};
use servoid_protocol::lease::ABANDONED_RUN_IS_OVER;
use servoid_protocol::message::{Command, RigMessage};
use std::time::Duration;

/// A run sends a frame every 20 ms: three times that lets one be lost.
const FRAMES_COME: Duration = Duration::from_millis(60);

/// A run whose frames have come does not come to its end before this much silence.
const FRAMES_STOP: Duration = Duration::from_millis(200);

/// Sends nothing while the frames of a run come, and opens a session when they stop. The rig would keep
/// to its own session anyway, but requests of two programs on one line may meet and damage each other.
pub(crate) struct ForeignTraffic {
    opening: Opening,
    begin: Duration,
    quiet_at: Duration,
}

impl ForeignTraffic {
    /// Listens from `now` on, before `opening`.
    pub(crate) fn new(opening: Opening, now: Duration) -> Self {
        Self {
            opening,
            begin: now,
            quiet_at: now + FRAMES_COME,
        }
    }
}

impl Task for ForeignTraffic {
    fn on_message(&mut self, message: &RigMessage, line: &mut Line) {
        if matches!(message, RigMessage::Frame(_)) {
            self.quiet_at = line.now + FRAMES_STOP;
        }
    }

    fn on_answer(&mut self, _command: &Command, _answer: Option<Answer>, _: &mut Line) -> Next {
        Next::Stay // nothing has been asked
    }

    fn on_time(&mut self, line: &mut Line) -> Next {
        if line.now >= self.quiet_at {
            line.listen_afresh();
            self.opening.begin(line);
            return Next::Then(Box::new(self.opening));
        }
        if line.now >= self.begin + ABANDONED_RUN_IS_OVER {
            line.fail(ClientError::RunOfAnother);
            return Next::Done;
        }
        Next::Stay
    }

    fn deadline(&self, _line: &Line) -> Option<Duration> {
        Some(self.quiet_at.min(self.begin + ABANDONED_RUN_IS_OVER))
    }
}
