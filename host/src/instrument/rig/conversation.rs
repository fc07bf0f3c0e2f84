//! Requests that are said until their answers come.

use super::talk_error::TalkError;
use crate::instrument::port::Port;
use servoid_protocol::message::{Command, Outcome, Refusal, Request, RigMessage, Status};
use servoid_protocol::{Decoder, Hello, framing};
use std::collections::VecDeque;
use std::time::Duration;

/// How long an answer may take before the request is said again. The rig answers within a frame
/// (20 ms), behind at most 512 bytes that wait for the line (45 ms at 115200 baud).
const ANSWER_TIMEOUT: Duration = Duration::from_millis(250);

/// How often a request is said. On the worst line that has to do, with 5 % of the frames lost and 5 %
/// of the others corrupted each way, fewer than one capture of 100 requests in a million fails for
/// want of an answer; the test at the end of this file has the arithmetic.
pub(super) const ATTEMPTS: u32 = 11;

/// A request that has been said, until its answer comes.
#[derive(Clone, Copy, Debug)]
pub struct Asked {
    request: Request,
    said_at: Duration,
    said: u32,
}

/// What came of a request.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Answer {
    /// Done, or already so.
    Done,
    /// Not done, and why.
    Refused(Refusal),
    /// Answer to [`Command::Hello`].
    Hello(Hello),
    /// Answer to [`Command::Status`].
    Status(Status),
}

impl Asked {
    /// What was asked for.
    #[must_use]
    pub fn command(&self) -> &Command {
        &self.request.command
    }

    /// The answer, if `message` is it.
    ///
    /// A `Hello` or `Status` carries no id: one that was asked for earlier and comes late is taken
    /// for the answer too.
    #[must_use]
    pub fn answer_in(&self, message: &RigMessage) -> Option<Answer> {
        let Request {
            session,
            id,
            command,
        } = self.request;
        match (*message, command) {
            (RigMessage::Hello(hello), Command::Hello) => Some(Answer::Hello(hello)),
            (RigMessage::Status(status), Command::Status) => Some(Answer::Status(status)),
            (
                RigMessage::Reply {
                    session: s,
                    id: i,
                    outcome,
                },
                _,
            ) if (s, i) == (session, id) => Some(match outcome {
                Outcome::Done => Answer::Done,
                Outcome::Refused(refusal) => Answer::Refused(refusal),
            }),
            _ => None,
        }
    }
}

/// Requests out, messages in, with nobody known yet at the other end.
pub(super) struct Conversation {
    pub(super) port: Box<dyn Port>,
    pub(super) decoder: Decoder,
    pub(super) session: u16,
    next_id: u16,
    pub(super) bytes_received: u64,
    /// Messages that came while an answer was waited for.
    pub(super) inbox: VecDeque<RigMessage>,
}

impl Conversation {
    /// Nothing said and nothing heard yet.
    pub(super) fn new(port: Box<dyn Port>, session: u16) -> Self {
        Self {
            port,
            decoder: Decoder::new(),
            session,
            next_id: 0,
            bytes_received: 0,
            inbox: VecDeque::new(),
        }
    }

    pub(super) fn say(&mut self, command: Command) -> Result<Asked, TalkError> {
        let request = Request {
            session: self.session,
            id: self.next_id,
            command,
        };
        self.next_id = self.next_id.wrapping_add(1);
        let mut asked = Asked {
            request,
            said_at: Duration::ZERO,
            said: 0,
        };
        self.say_again(&mut asked)?;
        Ok(asked)
    }

    pub(super) fn say_again(&mut self, asked: &mut Asked) -> Result<(), TalkError> {
        let mut buffer = [0; framing::MAX_WIRE];
        let wire = framing::encode(&asked.request, &mut buffer)
            .map_err(|e| std::io::Error::other(e.to_string()))?;
        self.port.write_all(wire)?;
        asked.said_at = self.port.now();
        asked.said += 1;
        Ok(())
    }

    /// Says the newest request again if its answer is overdue; `false` when that has been done often
    /// enough.
    pub(super) fn insist(&mut self, asked: &mut Asked) -> Result<bool, TalkError> {
        if self.port.now().saturating_sub(asked.said_at) < ANSWER_TIMEOUT {
            return Ok(true);
        }
        if asked.said >= ATTEMPTS {
            return Ok(false);
        }
        self.say_again(asked).map(|()| true)
    }

    /// Says `command` until its answer comes; the rest stays in the inbox in its order. `None` when
    /// no answer came.
    pub(super) fn ask(
        &mut self,
        command: Command,
        attempts: u32,
    ) -> Result<Option<Answer>, TalkError> {
        let mut asked = self.say(command)?;
        loop {
            let deadline = asked.said_at + ANSWER_TIMEOUT;
            loop {
                let left = deadline.saturating_sub(self.port.now());
                if left.is_zero() {
                    break;
                }
                let seen = self.inbox.len();
                self.fill_inbox(left)?;
                let new = self.inbox.iter().enumerate().skip(seen);
                let answer = new
                    .filter_map(|(i, m)| Some((i, asked.answer_in(m)?)))
                    .next();
                if let Some((i, answer)) = answer {
                    self.inbox.remove(i);
                    return Ok(Some(answer));
                }
            }
            if asked.said >= attempts {
                return Ok(None);
            }
            self.say_again(&mut asked)?;
        }
    }

    /// Lets `time` pass; what comes meanwhile stays in the inbox.
    pub(super) fn pause(&mut self, time: Duration) -> Result<(), TalkError> {
        let until = self.port.now() + time;
        loop {
            let left = until.saturating_sub(self.port.now());
            if left.is_zero() {
                return Ok(());
            }
            self.fill_inbox(left)?;
        }
    }

    /// Reads once from the port.
    pub(super) fn fill_inbox(&mut self, timeout: Duration) -> Result<(), TalkError> {
        let mut buffer = [0; 512];
        let count = self.port.read(&mut buffer, timeout)?;
        self.bytes_received += count as u64;
        let bytes = buffer.iter().take(count);
        self.inbox
            .extend(bytes.filter_map(|&byte| self.decoder.push::<RigMessage>(byte)));
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_attempts_keep_the_promise_on_the_worst_line_and_are_the_fewest() {
        let frame_fails = 1.0 - 0.95_f64 * 0.95;
        // A request fails where it or its answer does not get through.
        let attempt_fails = 1.0 - (1.0 - frame_fails).powi(2);
        let captures_failed = |attempts: u32| 100.0 * attempt_fails.powi(attempts as i32);
        assert!(captures_failed(ATTEMPTS) <= 1e-6);
        assert!(captures_failed(ATTEMPTS - 1) > 1e-6);
    }
}
