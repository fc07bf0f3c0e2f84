//! The messages that wait to be sent, and their order.

use crate::frame_history::History;
use core::ops::Range;
use heapless::Deque;
use servoid_protocol::message::{Ended, Frame, Outcome};

/// Longest queue of answers. A host has one request open at a time; the rest is for repeated requests that arrive
/// together after a delay of the line.
const ANSWERS: usize = 8;

/// Longest queue of ranges of frames to send again.
const RESENDS: usize = 8;

/// An answer to a request. Its content is read from the rig when it is sent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Answer {
    Hello,
    Status,
    Health,
    Vitals,
    Loopback,
    Reply {
        session: u16,
        id: u16,
        outcome: Outcome,
    },
}

/// The next thing to send.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Item {
    Answer(Answer),
    Ended(Ended),
    Again(Frame),
    Live(Frame),
    Visitor(Answer),
}

/// The queue, in this order:
///
/// 1. answers, because a host waits for them;
/// 2. frames to be sent again;
/// 3. the frames of the run, which wait in the history;
/// 4. the end of the run, so a host that gets it has got everything before it;
/// 5. the answer to a host without a session (a visitor), so no visitor takes the line from a run.
#[derive(Debug, Default)]
#[cfg_attr(test, derive(Clone))]
pub(crate) struct Outbox {
    answers: Deque<Answer, ANSWERS>,
    /// The end of a run.
    pub(crate) ended: Option<Ended>,
    resends: Deque<Range<u16>, RESENDS>,
    /// The newest answer to a visitor.
    pub(crate) visitor: Option<Answer>,
    /// Index of the first frame of the run that has not been sent.
    live: u16,
    /// Largest number of frames that have waited.
    pub(crate) backlog_high_water: u16,
}

impl Outbox {
    /// A new session: drops the answers and resends of the old one.
    pub(crate) fn new_session(&mut self) {
        self.answers.clear();
        self.resends.clear();
    }

    /// A new run: drops the resends and the end of the run before.
    pub(crate) fn new_run(&mut self) {
        self.resends.clear();
        self.ended = None;
        self.live = 0;
    }

    /// Queues an answer. A full queue drops the oldest: its host has given up or will repeat the request.
    pub(crate) fn answer(&mut self, answer: Answer) {
        push(&mut self.answers, answer);
    }

    /// Queues frames to be sent again; a full queue drops the oldest range.
    pub(crate) fn resend(&mut self, frames: Range<u16>) {
        push(&mut self.resends, frames);
    }

    /// Updates the largest number of waiting frames.
    pub(crate) fn measure_backlog(&mut self, history: &History) {
        let backlog = history.indices().end.saturating_sub(self.live);
        self.backlog_high_water = self.backlog_high_water.max(backlog);
    }

    /// The next thing to send. It stays the next one until [`Self::sent`].
    pub(crate) fn next(&mut self, history: &History) -> Option<Item> {
        if let Some(&answer) = self.answers.front() {
            return Some(Item::Answer(answer));
        }
        while let Some(wanted) = self.resends.front() {
            if let Some(frame) = history.first_of(wanted) {
                return Some(Item::Again(frame));
            }
            self.resends.pop_front();
        }
        let waiting = self.live..history.indices().end;
        let live = history.first_of(&waiting).map(Item::Live);
        live.or(self.ended.map(Item::Ended))
            .or(self.visitor.map(Item::Visitor))
    }

    /// The link has taken `item`, which [`Self::next`] gave.
    pub(crate) fn sent(&mut self, item: &Item) {
        match item {
            Item::Answer(_) => {
                self.answers.pop_front();
            }
            Item::Ended(_) => self.ended = None,
            Item::Visitor(_) => self.visitor = None,
            Item::Again(frame) => {
                if let Some(wanted) = self.resends.front_mut() {
                    wanted.start = frame.index.saturating_add(1);
                }
            }
            Item::Live(frame) => self.live = frame.index.saturating_add(1),
        }
    }
}

fn push<T, const N: usize>(queue: &mut Deque<T, N>, item: T) {
    if queue.is_full() {
        queue.pop_front();
    }
    // There is room now, so this cannot fail.
    let _ = queue.push_back(item);
}
