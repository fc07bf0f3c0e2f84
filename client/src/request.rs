//! A request that waits for its answer.

use servoid_protocol::loopback::{LoopbackFrame, Vitals};
use servoid_protocol::message::{Command, Outcome, Refusal, Request, RigMessage, Status};
use servoid_protocol::{Health, Hello};
use std::time::Duration;

/// How long an answer may take before the request is repeated. The rig answers within a frame
/// (20 ms), behind at most 512 bytes that wait for the line (45 ms at 115200 baud).
const ANSWER_TIMEOUT: Duration = Duration::from_millis(250);

/// How often a request is sent. On the worst line that has to do, with 5 % of the frames lost and 5 %
/// of the others corrupted each way, fewer than one capture of 100 requests in a million fails for
/// want of an answer; the test at the end of this file has the arithmetic.
pub(crate) const ATTEMPTS: u32 = 11;

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
    /// Answer to [`Command::Health`].
    Health(Health),
    /// Answer to [`Command::Vitals`].
    Vitals(Vitals),
    /// Answer to [`Command::Loopback`].
    Loopback(LoopbackFrame),
}

/// A request that was sent and has no answer yet.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PendingRequest {
    pub request: Request,
    /// How often it may be sent.
    pub attempts: u32,
    pub sent: u32,
    pub sent_at: Duration,
}

impl PendingRequest {
    /// When it is to be repeated.
    pub(crate) fn overdue_at(&self) -> Duration {
        self.sent_at + ANSWER_TIMEOUT
    }

    /// The answer, if `message` is it.
    ///
    /// A `Hello`, `Status`, `Health`, `Vitals` or `Loopback` carries no id: one that was asked for earlier and comes late is taken
    /// for the answer too.
    pub(crate) fn answer_in(&self, message: &RigMessage) -> Option<Answer> {
        let asked = (self.request.session, self.request.id);
        match (*message, self.request.command) {
            (RigMessage::Hello(hello), Command::Hello) => Some(Answer::Hello(hello)),
            (RigMessage::Status(status), Command::Status) => Some(Answer::Status(status)),
            (RigMessage::Health(health), Command::Health) => Some(Answer::Health(health)),
            (RigMessage::Vitals(vitals), Command::Vitals) => Some(Answer::Vitals(vitals)),
            (RigMessage::Loopback(frame), Command::Loopback(_)) => Some(Answer::Loopback(frame)),
            (
                RigMessage::Reply {
                    session,
                    id,
                    outcome,
                },
                _,
            ) if (session, id) == asked => Some(match outcome {
                Outcome::Done => Answer::Done,
                Outcome::Refused(refusal) => Answer::Refused(refusal),
            }),
            _ => None,
        }
    }
}

/// What error texts call a request.
pub(crate) fn name(command: &Command) -> &'static str {
    match command {
        Command::Unused | Command::Hello => "say who it is",
        Command::Status => "say how it is",
        Command::Health => "say how its board is",
        Command::Vitals => "say how its processor is",
        Command::Loopback(_) => "test itself",
        Command::Arm(_) | Command::ArmFor(_) => "arm",
        Command::Disarm => "disarm",
        Command::Start(_) => "start the run",
        Command::Stop { .. } => "stop the run",
        Command::KeepAlive => "prolong the lease",
        Command::Resend { .. } => "send frames again",
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
