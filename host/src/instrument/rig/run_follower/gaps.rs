//! Frames that are missing: when they are asked for again, and when they are given up.

use super::RunFollower;
use servoid_protocol::message::Command;
use servoid_protocol::timing::FRAME_US;
use std::ops::Range;
use std::time::Duration;

/// A gap is asked for again when the answer has had this long to come.
const RESEND_EVERY: Duration = Duration::from_millis(100);

/// Frames asked for at once: at 115200 baud and 36 bytes a frame they take a fifth of a second.
const RESEND_FRAMES: u32 = 64;

/// A gap that the rig has answered for so often without its first frame coming is given up once the
/// run is over. On a line that loses one frame in ten that is one gap in 10^12.
const FRUITLESS: u32 = 12;

/// A gap that was asked for.
pub(super) struct Resend {
    gap: Range<u32>,
    /// Answers to it without its first frame coming.
    pub(super) answers: u32,
    pub(super) answered_at: Option<Duration>,
}

impl RunFollower<'_> {
    /// Gives up gaps that the board cannot fill any more.
    pub(super) fn forget_what_cannot_come(&mut self) {
        let end = self.end_so_far();
        let history = u32::from(self.client.hello().history_frames);
        self.assembly.give_up_before(end.saturating_sub(history));
        if self.ended.is_some()
            && let Some(gap) = self.assembly.first_gap(end)
            && let Some(resend) = &self.resend
            && resend.gap.start == gap.start
            && resend.answers >= FRUITLESS
        {
            self.assembly.give_up_before(resend.gap.end);
        }
    }

    /// The request for the first gap, if it is time for it.
    pub(super) fn resend_due(&mut self, now: Duration) -> Option<Command> {
        let gap = self.assembly.first_gap(self.end_so_far())?;
        let at_the_end = gap.end == self.end_so_far();
        if at_the_end && now.saturating_sub(self.frame_at) < RESEND_EVERY {
            return None; // the last frames are still coming by themselves
        }
        let gap = gap.start..gap.end.min(gap.start + RESEND_FRAMES);
        let answers = match &self.resend {
            Some(before) if before.gap.start == gap.start => {
                let patience = RESEND_EVERY + line_time(&before.gap);
                if before
                    .answered_at
                    .is_some_and(|at| now.saturating_sub(at) < patience)
                {
                    return None;
                }
                before.answers
            }
            _ => 0,
        };
        let first = u16::try_from(gap.start).ok()?;
        let count = u16::try_from(gap.len()).ok()?;
        self.asked_again += u32::from(count);
        self.resend = Some(Resend {
            gap,
            answers,
            answered_at: None,
        });
        Some(Command::Resend {
            run: self.start.run,
            first,
            count,
        })
    }
}

/// How long the line takes for that many frames beside the live ones.
fn line_time(frames: &Range<u32>) -> Duration {
    // 40 bytes at 11 520 bytes/s are 3.5 ms; a fifth of a frame's time is a little more.
    Duration::from_micros(u64::from(FRAME_US) / 5 * frames.len() as u64)
}
