//! What a run was commanded to be, and what of a rig's messages cannot be true of it.
//!
//! Host and rig expand the reference with the same code. So the host knows how many frames a run has and which pulse
//! each of them gets, and believes no rig that says otherwise.

use servoid_protocol::message::{EndReason, Ended, Start};
use servoid_protocol::{Frame, PulseWidth};

/// A pulse may be on the line for so many frames after its own: the processor was away, and the board held the last
/// pulse that was set. Its watchdog ends that after 120 ms, which are six frames.
const MOST_FRAMES_LATE: u32 = 6;

/// A message of a rig that cannot be true of the run that was commanded.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Contradiction {
    /// A frame behind the last one.
    #[error("it sent frame {index} of a run that has {frames} frames")]
    FrameBeyondRun {
        /// The frame's index.
        index: u16,
        /// Frames of the run.
        frames: u32,
    },
    /// A pulse that was not commanded in this frame, nor shortly before it.
    #[error("it reports a pulse of {} µs in frame {index}, where {} µs was commanded", pulse.0, commanded.0)]
    OtherPulse {
        /// The frame's index.
        index: u16,
        /// The pulse that it reports.
        pulse: PulseWidth,
        /// The pulse of that frame.
        commanded: PulseWidth,
    },
    /// Another number of frames than the run has, or than it sent.
    #[error(
        "it reports the end of the run after {reported} frames, and the run has {frames}, of which {arrived} had come"
    )]
    OtherLength {
        /// The number that it reports.
        reported: u16,
        /// Frames of the run.
        frames: u32,
        /// One past the newest frame that has come.
        arrived: u32,
    },
}

/// A run as it was commanded.
#[derive(Debug)]
pub(crate) struct Commanded {
    start: Start,
    frames: u32,
    /// Unknown where something else than this client has armed the rig.
    neutral: Option<PulseWidth>,
}

impl Commanded {
    /// The run `start` on a rig that was armed with this neutral pulse.
    pub(crate) fn new(start: Start, neutral: Option<PulseWidth>) -> Self {
        Self {
            start,
            frames: start.frames(),
            neutral,
        }
    }

    fn pulse(&self, index: u32) -> Option<PulseWidth> {
        self.neutral?.offset_by(self.start.offset_us(index)?)
    }

    /// What cannot be true of a frame of this run.
    pub(crate) fn contradicts_frame(&self, frame: &Frame) -> Option<Contradiction> {
        let index = u32::from(frame.index);
        if index >= self.frames {
            return Some(Contradiction::FrameBeyondRun {
                index: frame.index,
                frames: self.frames,
            });
        }
        let commanded = self.pulse(index)?;
        let mut late = (index.saturating_sub(MOST_FRAMES_LATE)..=index).rev();
        (!late.any(|index| self.pulse(index) == Some(frame.pulse))).then_some(
            Contradiction::OtherPulse {
                index: frame.index,
                pulse: frame.pulse,
                commanded,
            },
        )
    }

    /// What cannot be true of the end of this run, of which frames up to `arrived` have come.
    pub(crate) fn contradicts_end(&self, ended: &Ended, arrived: u32) -> Option<Contradiction> {
        let reported = u32::from(ended.frames);
        let is_true = arrived <= reported
            && reported <= self.frames
            && ended.frames_lost_on_board <= ended.frames
            && (ended.reason != EndReason::Complete || reported == self.frames);
        (!is_true).then_some(Contradiction::OtherLength {
            reported: ended.frames,
            frames: self.frames,
            arrived,
        })
    }
}
