//! The frames of one run, put in order.
//!
//! Frames may come twice, late, or not at all. [`RunAssembly`] lets them out in order, each once,
//! and holds back what comes after a gap until the gap is filled or given up.

use servoid_protocol::message::RunCheck;
use servoid_protocol::{Frame, message::Ended};
use std::collections::BTreeMap;
use std::ops::Range;

/// Puts the frames of one run in order.
#[derive(Debug)]
pub struct RunAssembly {
    run: u16,
    /// Index of the next frame to let out.
    next: u32,
    /// Frames that wait for an earlier one.
    waiting: BTreeMap<u32, Frame>,
    /// Indices that have been given up.
    lost: Vec<Range<u32>>,
    check: RunCheck,
}

impl RunAssembly {
    /// A run of that number, of which nothing has come.
    #[must_use]
    pub fn new(run: u16) -> Self {
        Self {
            run,
            next: 0,
            waiting: BTreeMap::new(),
            lost: Vec::new(),
            check: RunCheck::new(),
        }
    }

    /// Takes a frame in; says whether it is a new one. Frames of other runs and frames that are here
    /// already are passed over.
    pub fn take_in(&mut self, frame: Frame) -> bool {
        let index = u32::from(frame.index);
        frame.run == self.run && index >= self.next && self.waiting.insert(index, frame).is_none()
    }

    /// Lets the next frame out, if it is here.
    pub fn let_out(&mut self) -> Option<Frame> {
        let frame = self.waiting.remove(&self.next)?;
        self.next += 1;
        self.check.update(&frame);
        Some(frame)
    }

    /// Frames let out or given up so far.
    #[must_use]
    pub fn position(&self) -> u32 {
        self.next
    }

    /// One past the newest frame that has come.
    #[must_use]
    pub fn newest(&self) -> u32 {
        self.waiting
            .last_key_value()
            .map_or(self.next, |(&index, _)| index + 1)
    }

    /// The first stretch of missing frames below `end`.
    #[must_use]
    pub fn first_gap(&self, end: u32) -> Option<Range<u32>> {
        // What could have been let out is no gap; a caller lets out before it asks.
        let gap_end = self.waiting.keys().next().copied().unwrap_or(end).min(end);
        (self.next < gap_end).then_some(self.next..gap_end)
    }

    /// Gives up every missing frame below `index`; what waited behind them can be let out.
    pub fn give_up_before(&mut self, index: u32) {
        let end = self
            .waiting
            .keys()
            .next()
            .copied()
            .unwrap_or(index)
            .min(index);
        if self.next < end {
            match self.lost.last_mut() {
                Some(last) if last.end == self.next => last.end = end,
                _ => self.lost.push(self.next..end),
            }
            self.next = end;
        }
    }

    /// The frames that have been given up.
    #[must_use]
    pub fn lost(&self) -> &[Range<u32>] {
        &self.lost
    }

    /// How many frames have been given up.
    #[must_use]
    pub fn given_up(&self) -> u32 {
        self.lost.iter().map(|gap| gap.end - gap.start).sum()
    }

    /// Whether everything that the board caught is here: then what is missing was lost on the board,
    /// and asking for it again brings nothing.
    #[must_use]
    pub fn lacks_only_what_the_board_lost(&self, ended: &Ended) -> bool {
        let missing_ahead = u32::from(ended.frames)
            .saturating_sub(self.next)
            .saturating_sub(self.waiting.len() as u32);
        let mut check = self.check.clone();
        self.waiting.values().for_each(|frame| check.update(frame));
        self.given_up() + missing_ahead == u32::from(ended.frames_lost_on_board)
            && check.value() == ended.check
    }

    /// Whether what was let out is, frame by frame, the run that the rig made.
    #[must_use]
    pub fn is_whole(&self, ended: &Ended) -> bool {
        self.lost.is_empty()
            && ended.frames_lost_on_board == 0
            && self.next == u32::from(ended.frames)
            && self.check.value() == ended.check
    }
}

#[cfg(test)]
mod tests {
    use super::*;
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

    fn let_all_out(run: &mut RunAssembly) -> Vec<u16> {
        std::iter::from_fn(|| run.let_out())
            .map(|f| f.index)
            .collect()
    }

    #[test]
    fn frames_come_out_in_order_and_once() {
        let mut run = RunAssembly::new(7);
        for index in [0, 0, 2, 1, 2, 3, 1] {
            run.take_in(frame(index));
        }
        run.take_in(Frame { run: 6, ..frame(4) });
        assert_eq!(let_all_out(&mut run), [0, 1, 2, 3]);
        assert!(run.is_whole(&ended(4)));
        assert!(!run.is_whole(&ended(5)), "one is missing at the end");
    }

    #[test]
    fn a_gap_holds_back_until_it_is_filled() {
        let mut run = RunAssembly::new(7);
        for index in [0, 3, 4] {
            run.take_in(frame(index));
        }
        assert_eq!(let_all_out(&mut run), [0]);
        assert_eq!((run.first_gap(9), run.newest()), (Some(1..3), 5));
        run.take_in(frame(1));
        run.take_in(frame(2));
        assert_eq!(let_all_out(&mut run), [1, 2, 3, 4]);
        assert_eq!(run.first_gap(6), Some(5..6), "missing at the end");
        assert!(run.is_whole(&ended(5)));
    }

    #[test]
    fn a_gap_given_up_is_named() {
        let mut run = RunAssembly::new(7);
        for index in [0, 3, 5] {
            run.take_in(frame(index));
        }
        assert_eq!(let_all_out(&mut run), [0]);
        run.give_up_before(3);
        assert_eq!(let_all_out(&mut run), [3]);
        run.give_up_before(9);
        assert_eq!(let_all_out(&mut run), [5]);
        assert_eq!(run.lost(), [1..3, 4..5]);
        assert!(!run.is_whole(&ended(6)));
    }

    #[test]
    fn a_changed_sample_is_not_the_run() {
        let mut run = RunAssembly::new(7);
        run.take_in(Frame {
            samples: [Counts(1); 10],
            ..frame(0)
        });
        let_all_out(&mut run);
        assert!(!run.is_whole(&ended(1)));
    }
}
