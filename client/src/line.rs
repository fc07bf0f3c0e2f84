//! The line to the rig as a task sees it: requests out, messages in, events for the driver.

use crate::error::ClientError;
use crate::event::Event;
use crate::request::{ATTEMPTS, Answer, PendingRequest};
use servoid_protocol::message::{ArmFor, Command, Request, RigMessage, Status};
use servoid_protocol::{Decoder, Hello, PulseTrain, framing};
use std::collections::VecDeque;
use std::time::Duration;

/// Everything that outlives a single task.
pub(crate) struct Line {
    /// The time, as the driver gave it last.
    pub now: Duration,
    pub hello: Option<Hello>,
    /// The newest status of the rig in the run under way or the last one.
    pub status: Option<Status>,
    /// Frames of that run that had to be asked for again.
    pub asked_again: u32,
    pub decoder: Decoder,
    pub bytes_received: u64,
    pub outgoing: VecDeque<Vec<u8>>,
    pub events: VecDeque<Event>,
    /// Requests that were sent again.
    pub repeated: u32,
    /// The pulses and the limits that the rig was last asked to keep.
    pub armed: Option<ArmFor>,
    session: u16,
    next_id: u16,
    pending: Option<PendingRequest>,
}

impl Line {
    /// A line on which nothing has been sent or received.
    pub(crate) fn new(session: u16, now: Duration) -> Self {
        Self {
            now,
            hello: None,
            status: None,
            asked_again: 0,
            decoder: Decoder::new(),
            bytes_received: 0,
            outgoing: VecDeque::new(),
            events: VecDeque::new(),
            repeated: 0,
            armed: None,
            session,
            next_id: 0,
            pending: None,
        }
    }

    /// The messages that `bytes` complete.
    pub(crate) fn receive(&mut self, bytes: &[u8]) -> Vec<RigMessage> {
        self.bytes_received += bytes.len() as u64;
        let messages = bytes.iter().filter_map(|&byte| self.decoder.push(byte));
        messages.collect()
    }

    /// Forgets what has been heard, as it is not of this session.
    pub(crate) fn listen_afresh(&mut self) {
        (self.decoder, self.bytes_received) = (Decoder::new(), 0);
    }

    /// Goes on under another session's number.
    pub(crate) fn change_session(&mut self) {
        self.session = self.session.wrapping_add(1);
    }

    /// Sends a new request, and repeats it until its answer comes. It overtakes the request before it,
    /// which the rig answers no more.
    pub(crate) fn ask(&mut self, command: Command) {
        self.ask_patiently(command, ATTEMPTS);
    }

    /// [`Line::ask`], sent at most so many times.
    pub(crate) fn ask_patiently(&mut self, command: Command, attempts: u32) {
        match command {
            Command::Arm(arm) => {
                let train = PulseTrain::USUAL;
                self.armed = Some(ArmFor { train, arm });
            }
            Command::ArmFor(asked) => self.armed = Some(asked),
            _ => {}
        }
        let request = Request {
            session: self.session,
            id: self.next_id,
            command,
        };
        self.next_id = self.next_id.wrapping_add(1);
        self.send(PendingRequest {
            request,
            attempts,
            sent: 0,
            sent_at: self.now,
        });
    }

    fn send(&mut self, request: PendingRequest) {
        // No request is longer than a frame can be; one that were would be a request without an answer.
        if let Ok(wire) = framing::encode(&request.request, &mut [0; framing::MAX_WIRE]) {
            self.outgoing.push_back(wire.to_vec());
        }
        self.pending = Some(PendingRequest {
            sent: request.sent + 1,
            sent_at: self.now,
            ..request
        });
    }

    /// What waits for its answer.
    pub(crate) fn pending(&self) -> Option<&Command> {
        self.pending
            .as_ref()
            .map(|pending| &pending.request.command)
    }

    /// What was asked, and the answer, if `message` is one.
    pub(crate) fn take_answer(&mut self, message: &RigMessage) -> Option<(Command, Answer)> {
        let answer = self.pending?.answer_in(message)?;
        let answered = self.pending.take()?;
        Some((answered.request.command, answer))
    }

    /// Repeats a request whose answer is overdue; returns it where that has been done often enough.
    pub(crate) fn insist(&mut self) -> Option<Command> {
        let pending = self.pending?;
        if self.now < pending.overdue_at() {
            return None;
        }
        if pending.sent < pending.attempts {
            self.repeated += 1;
            self.send(pending);
            return None;
        }
        self.pending = None;
        Some(pending.request.command)
    }

    /// When [`Line::insist`] has something to do.
    pub(crate) fn deadline(&self) -> Option<Duration> {
        self.pending.map(|pending| pending.overdue_at())
    }

    pub(crate) fn fail(&mut self, error: ClientError) {
        self.events.push_back(Event::Failed(error));
    }
}
