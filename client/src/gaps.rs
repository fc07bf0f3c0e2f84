//! Frames that are missing: when they are asked for again, and when they are given up.

use crate::frame_order::FrameOrder;
use std::ops::Range;
use std::time::Duration;

/// A gap is asked for again when the answer has had this long to come.
const RESEND_EVERY: Duration = Duration::from_millis(100);

/// Frames asked for at once: at 115200 baud and 36 bytes a frame they take a fifth of a second.
const RESEND_FRAMES: u32 = 64;

/// A gap that the rig has answered for so often without its first frame coming is given up once the
/// run is over. On a line that loses one frame in ten that is one gap in 10^12.
const FRUITLESS: u32 = 12;

/// The gaps of one run.
#[derive(Debug)]
pub(crate) struct Gaps {
    /// Frames that the board keeps.
    history_frames: u32,
    resend: Option<Resend>,
}

/// A gap that was asked for.
#[derive(Debug)]
struct Resend {
    gap: Range<u32>,
    /// Answers to it without its first frame coming.
    answers: u32,
    answered_at: Option<Duration>,
}

impl Gaps {
    /// Of a run on a board that keeps so many frames.
    pub(crate) fn new(history_frames: u16) -> Self {
        Self {
            history_frames: history_frames.into(),
            resend: None,
        }
    }

    /// Gives up the first gap below `end` if the board cannot fill it any more; says whether it did.
    pub(crate) fn give_up_hopeless(&self, order: &mut FrameOrder, end: u32, is_over: bool) -> bool {
        if order.give_up_before(end.saturating_sub(self.history_frames)) {
            return true;
        }
        match (order.first_gap(end), &self.resend) {
            (Some(gap), Some(resend)) => {
                is_over
                    && resend.gap.start == gap.start
                    && resend.answers >= FRUITLESS
                    && order.give_up_before(resend.gap.end)
            }
            _ => false,
        }
    }

    /// The next frames to ask for again, of those below `end`, and when; the last frame came at
    /// `frame_at`.
    pub(crate) fn due(
        &self,
        order: &FrameOrder,
        end: u32,
        frame_at: Duration,
    ) -> Option<(Duration, Range<u32>)> {
        let gap = order.first_gap(end)?;
        // The last frames of a run may still be coming by themselves.
        let mut at = match gap.end == end {
            true => frame_at + RESEND_EVERY,
            false => Duration::ZERO,
        };
        // Frames that were asked for a moment ago are still coming.
        let before = self.resend.as_ref();
        if let Some(before) = before.filter(|resend| resend.gap.contains(&gap.start))
            && let Some(answered_at) = before.answered_at
        {
            at = at.max(answered_at + RESEND_EVERY + line_time(&before.gap));
        }
        Some((at, gap.start..gap.end.min(gap.start + RESEND_FRAMES)))
    }

    /// A gap has been asked for.
    pub(crate) fn asked(&mut self, gap: Range<u32>) {
        let before = self.resend.take().filter(|r| r.gap.start == gap.start);
        self.resend = Some(Resend {
            gap,
            answers: before.map_or(0, |before| before.answers),
            answered_at: None,
        });
    }

    /// The rig has said that the frames will follow.
    pub(crate) fn answered(&mut self, now: Duration) {
        if let Some(resend) = &mut self.resend {
            resend.answers += 1;
            resend.answered_at = Some(now);
        }
    }
}

/// How long the line takes for that many frames beside the live ones: 40 bytes at 11 520 bytes/s are 3.5 ms.
fn line_time(frames: &Range<u32>) -> Duration {
    Duration::from_millis(4 * frames.len() as u64)
}
