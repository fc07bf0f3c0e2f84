//! What waits to be sent, and in which order.

use crate::history::History;
use core::ops::Range;
use heapless::Deque;
use servoid_protocol::message::{Ended, Frame, Outcome};

/// Answers that may wait. A host asks one thing at a time; a few more are room for repeated
/// requests that arrive together after the line was held up.
const ANSWERS: usize = 8;

/// Ranges of frames to send again that may wait.
const RESENDS: usize = 8;

/// An answer to a request. What it says of the rig is looked up when it is sent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Answer {
    Hello,
    Status,
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

/// Answers first, because a host waits for them; then frames to be sent again; then the run's
/// frames in order, which wait in the history; then its end, so that a host that has heard of the
/// end has been told everything. Who has no session is answered when all that is said, so that no
/// visitor, however insistent, takes the line from a run.
#[derive(Debug, Default)]
#[cfg_attr(test, derive(Clone))]
pub(crate) struct Outbox {
    answers: Deque<Answer, ANSWERS>,
    ended: Option<Ended>,
    resends: Deque<Range<u16>, RESENDS>,
    /// The newest answer to a visitor.
    visitor: Option<Answer>,
    /// Index of the first frame of the run that has not been sent.
    live: u16,
    backlog_high_water: u16,
}

impl Outbox {
    /// Another host has come: nobody waits for these answers and resends any more.
    pub(crate) fn new_session(&mut self) {
        self.answers.clear();
        self.resends.clear();
    }

    /// A run begins: the frames of the one before are gone, and whoever began it knows that that one
    /// is over.
    pub(crate) fn new_run(&mut self) {
        self.resends.clear();
        self.ended = None;
        self.live = 0;
    }

    /// Queues an answer. Where there is no room the oldest gives way: its host has either given up
    /// on it or will ask again.
    pub(crate) fn answer(&mut self, answer: Answer) {
        push(&mut self.answers, answer);
    }

    /// Keeps an answer to someone who has no session; it takes the place of the one before.
    pub(crate) fn answer_visitor(&mut self, answer: Answer) {
        self.visitor = Some(answer);
    }

    /// Queues the end of a run.
    pub(crate) fn ended(&mut self, ended: Ended) {
        self.ended = Some(ended);
    }

    /// Queues frames to be sent again; the oldest wish gives way as in [`Self::answer`].
    pub(crate) fn resend(&mut self, frames: Range<u16>) {
        push(&mut self.resends, frames);
    }

    /// Notes how many frames wait now.
    pub(crate) fn measure_backlog(&mut self, history: &History) {
        let backlog = history.indices().end.saturating_sub(self.live);
        self.backlog_high_water = self.backlog_high_water.max(backlog);
    }

    /// The most frames that ever waited.
    pub(crate) fn backlog_high_water(&self) -> u16 {
        self.backlog_high_water
    }

    /// The next thing to send. It stays the next one until [`Self::sent`] is told of it.
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
    // There is room now, so nothing comes back.
    let _ = queue.push_back(item);
}
