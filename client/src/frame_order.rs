//! The frames of one run, put in order.
//!
//! Frames may come twice, late, or not at all. [`FrameOrder`] releases them in order, each once, and
//! holds back those behind a gap until the gap is filled or given up.

use servoid_protocol::message::RunCheck;
use servoid_protocol::{Frame, message::Ended};
use std::collections::BTreeMap;
use std::ops::Range;

/// Puts the frames of one run in order.
#[derive(Debug)]
pub(crate) struct FrameOrder {
    run: u16,
    /// Index of the next frame to release.
    next: u32,
    /// Frames that wait for an earlier one.
    waiting: BTreeMap<u32, Frame>,
    given_up: u32,
    check: RunCheck,
}

impl FrameOrder {
    /// A run of that number, of which nothing has come.
    pub(crate) fn new(run: u16) -> Self {
        Self {
            run,
            next: 0,
            waiting: BTreeMap::new(),
            given_up: 0,
            check: RunCheck::new(),
        }
    }

    /// Takes a frame; says whether it is a new one. Frames of other runs and frames that are here
    /// already are passed over.
    pub(crate) fn insert(&mut self, frame: Frame) -> bool {
        let index = u32::from(frame.index);
        frame.run == self.run && index >= self.next && self.waiting.insert(index, frame).is_none()
    }

    /// Releases the next frame, if it is here.
    pub(crate) fn pop_ready(&mut self) -> Option<Frame> {
        let frame = self.waiting.remove(&self.next)?;
        self.next += 1;
        self.check.update(&frame);
        Some(frame)
    }

    /// Frames released or given up so far.
    pub(crate) fn position(&self) -> u32 {
        self.next
    }

    /// One past the newest frame that has come.
    pub(crate) fn newest(&self) -> u32 {
        let newest = self.waiting.last_key_value();
        newest.map_or(self.next, |(&index, _)| index + 1)
    }

    /// The first stretch of missing frames below `end`. A frame that is ready is no gap: release first.
    pub(crate) fn first_gap(&self, end: u32) -> Option<Range<u32>> {
        let waiting = self.waiting.keys().next().copied();
        let gap_end = waiting.unwrap_or(end).min(end);
        (self.next < gap_end).then_some(self.next..gap_end)
    }

    /// Gives up the missing frames below `index`, up to the next one that is here; says whether there
    /// were any.
    pub(crate) fn give_up_before(&mut self, index: u32) -> bool {
        let Some(gap) = self.first_gap(index) else {
            return false;
        };
        self.given_up += gap.end - gap.start;
        self.next = gap.end;
        true
    }

    /// How many frames have been given up.
    pub(crate) fn given_up(&self) -> u32 {
        self.given_up
    }

    /// Whether every frame that the board caught is here. Missing frames were lost on the board then,
    /// and asking for them again brings nothing.
    pub(crate) fn lacks_only_what_the_board_lost(&self, ended: &Ended) -> bool {
        let frames = u32::from(ended.frames);
        let waiting = || self.waiting.range(..frames).map(|(_, frame)| frame);
        let missing_ahead = frames
            .saturating_sub(self.next)
            .saturating_sub(waiting().count() as u32);
        let mut check = self.check.clone();
        waiting().for_each(|frame| check.update(frame));
        self.given_up + missing_ahead == u32::from(ended.frames_lost_on_board)
            && check.value() == ended.check
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run_ending::{Arrived, RunEnding};
    use servoid_protocol::message::EndReason;
    use servoid_protocol::{Counts, PulseWidth};

    fn frame(index: u16) -> Frame {
        Frame {
            run: 7,
            index,
            pulse: PulseWidth(1500),
            samples: [Counts(index); 10],
        }
    }

    fn ended(frames: u16) -> Ended {
        let mut check = RunCheck::new();
        (0..frames).for_each(|i| check.update(&frame(i)));
        let reason = EndReason::Complete;
        Ended {
            run: 7,
            reason,
            frames,
            frames_lost_on_board: 0,
            check: check.value(),
        }
    }

    fn arrived(run: &FrameOrder, ended: &Ended) -> Arrived {
        RunEnding::of(ended, run).arrived
    }

    fn release_all(run: &mut FrameOrder) -> Vec<u16> {
        std::iter::from_fn(|| run.pop_ready())
            .map(|f| f.index)
            .collect()
    }

    #[test]
    fn frames_come_out_in_order_and_once() {
        let mut run = FrameOrder::new(7);
        for index in [0, 0, 2, 1, 2, 3, 1] {
            run.insert(frame(index));
        }
        run.insert(Frame { run: 6, ..frame(4) });
        assert_eq!(release_all(&mut run), [0, 1, 2, 3]);
        assert_eq!(arrived(&run, &ended(4)), Arrived::Whole);
        assert_ne!(
            arrived(&run, &ended(5)),
            Arrived::Whole,
            "one is missing at the end"
        );
    }

    #[test]
    fn a_gap_holds_back_until_it_is_filled() {
        let mut run = FrameOrder::new(7);
        for index in [0, 3, 4] {
            run.insert(frame(index));
        }
        assert_eq!(release_all(&mut run), [0]);
        assert_eq!((run.first_gap(9), run.newest()), (Some(1..3), 5));
        run.insert(frame(1));
        run.insert(frame(2));
        assert_eq!(release_all(&mut run), [1, 2, 3, 4]);
        assert_eq!(run.first_gap(6), Some(5..6), "missing at the end");
        assert_eq!(arrived(&run, &ended(5)), Arrived::Whole);
    }

    #[test]
    fn a_gap_given_up_is_named() {
        let mut run = FrameOrder::new(7);
        for index in [0, 3, 5] {
            run.insert(frame(index));
        }
        assert_eq!(release_all(&mut run), [0]);
        run.give_up_before(3);
        assert_eq!(release_all(&mut run), [3]);
        run.give_up_before(9);
        assert_eq!(release_all(&mut run), [5]);
        assert_eq!(run.given_up(), 3, "1, 2 and 4");
        assert_eq!(arrived(&run, &ended(6)), Arrived::LostOnLine);
    }

    #[test]
    fn a_changed_sample_is_not_the_run() {
        let mut run = FrameOrder::new(7);
        run.insert(Frame {
            samples: [Counts(1); 10],
            ..frame(0)
        });
        release_all(&mut run);
        assert_eq!(arrived(&run, &ended(1)), Arrived::CheckDiffers);
    }
}
