//! How long nothing may come of a run.

use crate::error::ClientError;
use std::time::Duration;

/// Without a frame for this long, the rig is asked whether the run is over, and again every time.
const QUIET: Duration = Duration::from_millis(200);

/// Nothing readable for this long, and the rig is taken for gone. The board's memory is five seconds
/// long: waiting twice that lets a plug that was pulled be put back without losing anything.
const SILENT: Duration = Duration::from_secs(10);

/// The rig answers, and no frame has come that was not there already.
const STANDS_STILL: Duration = Duration::from_secs(20);

/// When something last came of a run.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Silence {
    /// Anything readable.
    pub message_at: Duration,
    /// A frame, new or not.
    pub frame_at: Duration,
    /// A new frame, or the end.
    pub progress_at: Duration,
}

impl Silence {
    /// Everything has come just now.
    pub(crate) fn since(now: Duration) -> Self {
        Self {
            message_at: now,
            frame_at: now,
            progress_at: now,
        }
    }

    /// When the rig is to be asked for its status, if it was last asked at `asked_at`.
    pub(crate) fn question_at(&self, asked_at: Duration) -> Duration {
        self.frame_at.max(asked_at) + QUIET
    }

    /// When [`Silence::lasts_too_long`], if nothing comes before.
    pub(crate) fn deadline(&self) -> Duration {
        (self.message_at + SILENT).min(self.progress_at + STANDS_STILL)
    }

    /// Why a run is not to be followed any longer.
    pub(crate) fn lasts_too_long(&self, now: Duration) -> Option<ClientError> {
        if now >= self.message_at + SILENT {
            let seconds = SILENT.as_secs();
            return Some(ClientError::FellSilent { seconds });
        }
        let seconds = STANDS_STILL.as_secs();
        (now >= self.progress_at + STANDS_STILL).then_some(ClientError::NoFrames { seconds })
    }
}
