//! Commands on their way to where they act.

use servoid_protocol::PulseWidth;
use std::collections::VecDeque;
use std::time::Duration;

/// Holds each command back for a fixed time.
#[derive(Clone, Debug)]
pub(crate) struct DelayLine {
    delay: Duration,
    /// When each command acts, and the command; earliest first.
    waiting: VecDeque<(Duration, Option<PulseWidth>)>,
}

impl DelayLine {
    pub(crate) fn new(delay: Duration) -> Self {
        Self {
            delay,
            waiting: VecDeque::new(),
        }
    }

    /// A command given at `at`. A command that is out of order acts together with the one before it.
    pub(crate) fn push(&mut self, at: Duration, pulse: Option<PulseWidth>) {
        let newest = self.waiting.back().map_or(Duration::ZERO, |last| last.0);
        let acts = (at + self.delay).max(newest);
        self.waiting.push_back((acts, pulse));
    }

    /// The next command that acts at or before `at`, with the time at which it acts.
    pub(crate) fn pop_due(&mut self, at: Duration) -> Option<(Duration, Option<PulseWidth>)> {
        self.waiting.pop_front_if(|(acts, _)| *acts <= at)
    }
}
