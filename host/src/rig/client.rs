//! Requests that arrive, answers that belong to them.

use crate::port::Port;
use servoid_protocol::hello::SCHEMA_HASH;
use servoid_protocol::message::{Command, Outcome, Refusal, Request, RigMessage, Status};
use servoid_protocol::{Decoder, Hello, Rejects, framing};
use std::collections::VecDeque;
use std::time::Duration;

/// How long an answer may take before the request is said again. The rig answers within a frame
/// (20 ms), behind at most 512 bytes that wait for the line (45 ms at 115200 baud).
const ANSWER_TIMEOUT: Duration = Duration::from_millis(250);

/// How often a request is said. Eight lost in a row, each way one in five, is one in 10^4.
const ATTEMPTS: u32 = 8;

/// A board that has just been plugged in needs a moment until it answers (bootloader, USB bridge).
const HELLO_ATTEMPTS: u32 = 12;

/// A look at a port that may well be something else.
const PROBE_ATTEMPTS: u32 = 3;

/// Why a rig cannot be talked to. The text says what to do.
#[derive(Debug, thiserror::Error)]
pub enum TalkError {
    /// Not a byte came.
    #[error(
        "nothing on {port} answers: check that the board has power, is flashed with servoid-firmware, and that RX and TX are crossed"
    )]
    Silent {
        /// The port's address.
        port: String,
    },
    /// Bytes come, but none of them make sense.
    #[error(
        "{port} sends bytes that are not a rig's ({bytes} bytes, no message in them): another device, another baud rate than 115200, or a noisy line"
    )]
    Garbled {
        /// The port's address.
        port: String,
        /// How many bytes came.
        bytes: u64,
    },
    /// It answered once and no longer does.
    #[error("the rig does not answer to {request}: check the cable and its power")]
    NoAnswer {
        /// What was asked.
        request: &'static str,
    },
    /// The rig was built for other messages.
    #[error(
        "the rig speaks another protocol (its schema is {rig:016x}, this servoid's is {host:016x}): flash the firmware of this version with 'cargo fw-flash'"
    )]
    SchemaDiffers {
        /// The rig's schema hash.
        rig: u64,
        /// This program's schema hash.
        host: u64,
    },
    /// The rig says no.
    #[error("the rig refuses to {request}: {}", refusal_text(*.refusal))]
    Refused {
        /// What was asked.
        request: &'static str,
        /// Why not.
        refusal: Refusal,
    },
    /// The stream broke.
    #[error("the connection broke: {0}")]
    Broken(#[from] std::io::Error),
}

fn refusal_text(refusal: Refusal) -> &'static str {
    match refusal {
        Refusal::UnknownSession => "another program has taken over the rig; start again",
        Refusal::Outdated => "a newer request has overtaken this one; start again",
        Refusal::SchemaDiffers => {
            "it was built for another protocol; flash this version's firmware"
        }
        Refusal::NotArmed => "it is not armed, or has been reset since it was; start again",
        Refusal::Running => "a run is under way; wait for its end",
        Refusal::BadLimits => {
            "the limits are outside what the board allows, or neutral is outside the limits; mend 'limits' and 'servo.neutral_us' in the rig file"
        }
        Refusal::BeyondLimits => {
            "the reference leaves the limits; choose a smaller amplitude or wider 'limits' in the rig file"
        }
        Refusal::BadReference => "the reference is empty or too long for one run; make it shorter",
        Refusal::UnknownRun => "it knows nothing of that run; it may have been reset",
        Refusal::RunRepeated => "its number is that of the run before; start again",
        Refusal::SensorOutOfRange => {
            "the sensor reads outside its healthy range; check its wiring and supply, or 'sensor.healthy_counts' in the rig file"
        }
    }
}

/// A rig at the other end of a port.
pub struct RigClient {
    talk: Conversation,
    hello: Hello,
}

/// Requests out, messages in, with nobody known yet at the other end.
struct Conversation {
    port: Box<dyn Port>,
    decoder: Decoder,
    session: u16,
    next_id: u16,
    bytes_received: u64,
    /// Messages that came while an answer was waited for.
    inbox: VecDeque<RigMessage>,
}

impl RigClient {
    /// Opens a session on a port; `address` is what error texts call it.
    ///
    /// # Errors
    /// [`TalkError::Silent`] or [`TalkError::Garbled`] when no rig is there.
    pub fn connect(port: Box<dyn Port>, address: &str) -> Result<Self, TalkError> {
        Self::say_hello(port, address, HELLO_ATTEMPTS)
    }

    /// [`RigClient::connect`] without patience: to find out quickly which of many ports is a rig.
    ///
    /// # Errors
    /// As [`RigClient::connect`].
    pub fn probe(port: Box<dyn Port>, address: &str) -> Result<Self, TalkError> {
        Self::say_hello(port, address, PROBE_ATTEMPTS)
    }

    fn say_hello(port: Box<dyn Port>, address: &str, attempts: u32) -> Result<Self, TalkError> {
        let mut talk = Conversation {
            port,
            decoder: Decoder::new(),
            session: session_number(),
            next_id: 0,
            bytes_received: 0,
            inbox: VecDeque::new(),
        };
        let hello = talk.ask(Command::Hello, attempts, |message| match message {
            RigMessage::Hello(hello) => Some(hello),
            _ => None,
        })?;
        let port = address.to_owned();
        match (hello, talk.bytes_received) {
            (Some(hello), _) => Ok(Self { talk, hello }),
            (None, 0) => Err(TalkError::Silent { port }),
            (None, bytes) => Err(TalkError::Garbled { port, bytes }),
        }
    }

    /// Who the rig is.
    #[must_use]
    pub fn hello(&self) -> &Hello {
        &self.hello
    }

    /// What could not be read of what the rig sent.
    #[must_use]
    pub fn rejects(&self) -> Rejects {
        self.talk.decoder.rejects()
    }

    /// The port's clock.
    #[must_use]
    pub fn now(&self) -> Duration {
        self.talk.port.now()
    }

    /// Refuses to go on with a rig that was built for other messages.
    ///
    /// # Errors
    /// [`TalkError::SchemaDiffers`].
    pub fn require_equal_schema(&self) -> Result<(), TalkError> {
        match self.hello.schema_hash {
            SCHEMA_HASH => Ok(()),
            rig => Err(TalkError::SchemaDiffers {
                rig,
                host: SCHEMA_HASH,
            }),
        }
    }

    /// How the rig is.
    ///
    /// # Errors
    /// When it does not answer.
    pub fn status(&mut self) -> Result<Status, TalkError> {
        let status = self
            .talk
            .ask(Command::Status, ATTEMPTS, |message| match message {
                RigMessage::Status(status) => Some(status),
                _ => None,
            })?;
        status.ok_or(TalkError::NoAnswer {
            request: name(&Command::Status),
        })
    }

    /// Has the rig do something; returns when it has said that it did.
    ///
    /// # Errors
    /// When it refuses, or does not answer.
    pub fn request(&mut self, command: Command) -> Result<(), TalkError> {
        let request = name(&command);
        let (session, id) = (self.talk.session, self.talk.next_id);
        let outcome = self.talk.ask(command, ATTEMPTS, |message| match message {
            RigMessage::Reply {
                session: s,
                id: i,
                outcome,
            } if (s, i) == (session, id) => Some(outcome),
            _ => None,
        })?;
        match outcome {
            Some(Outcome::Done) => Ok(()),
            Some(Outcome::Refused(refusal)) => Err(TalkError::Refused { request, refusal }),
            None => Err(TalkError::NoAnswer { request }),
        }
    }

    /// The next message that is no answer, waiting up to `timeout` for it.
    ///
    /// # Errors
    /// When the stream broke.
    pub fn receive(&mut self, timeout: Duration) -> Result<Option<RigMessage>, TalkError> {
        let deadline = self.now() + timeout;
        loop {
            if let Some(message) = self.talk.inbox.pop_front() {
                return Ok(Some(message));
            }
            let left = deadline.saturating_sub(self.now());
            if left.is_zero() {
                return Ok(None);
            }
            self.talk.fill_inbox(left)?;
        }
    }
}

impl Conversation {
    /// Says `command` until `is_answer` picks its answer out of what comes; the rest stays in the
    /// inbox in its order. `None` when no answer came.
    fn ask<T>(
        &mut self,
        command: Command,
        attempts: u32,
        is_answer: impl Fn(RigMessage) -> Option<T>,
    ) -> Result<Option<T>, TalkError> {
        let request = Request {
            session: self.session,
            id: self.next_id,
            command,
        };
        self.next_id = self.next_id.wrapping_add(1);
        let mut buffer = [0; framing::MAX_WIRE];
        let wire = framing::encode(&request, &mut buffer)
            .map_err(|e| std::io::Error::other(e.to_string()))?;
        for _ in 0..attempts {
            self.port.write_all(wire)?;
            let deadline = self.port.now() + ANSWER_TIMEOUT;
            loop {
                let left = deadline.saturating_sub(self.port.now());
                if left.is_zero() {
                    break;
                }
                let seen = self.inbox.len();
                self.fill_inbox(left)?;
                let answer =
                    (seen..self.inbox.len()).find_map(|i| Some((i, is_answer(self.inbox[i])?)));
                if let Some((i, answer)) = answer {
                    self.inbox.remove(i);
                    return Ok(Some(answer));
                }
            }
        }
        Ok(None)
    }

    /// Reads once from the port.
    fn fill_inbox(&mut self, timeout: Duration) -> Result<(), TalkError> {
        let mut buffer = [0; 512];
        let count = self.port.read(&mut buffer, timeout)?;
        self.bytes_received += count as u64;
        let bytes = buffer.iter().take(count);
        self.inbox
            .extend(bytes.filter_map(|&byte| self.decoder.push::<RigMessage>(byte)));
        Ok(())
    }
}

/// What error texts call a request.
fn name(command: &Command) -> &'static str {
    match command {
        Command::Unused | Command::Hello => "say who it is",
        Command::Status => "say how it is",
        Command::Arm(_) => "arm",
        Command::Disarm => "disarm",
        Command::Start(_) => "start the run",
        Command::Stop { .. } => "stop the run",
        Command::KeepAlive => "prolong the lease",
        Command::Resend { .. } => "send frames again",
    }
}

/// A number that two programs on one rig will hardly both choose. It need not be random in any
/// stronger sense: it tells sessions apart, it does not protect them.
#[must_use]
pub fn session_number() -> u16 {
    let now = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH);
    let nanos = now.map_or(0, |d| d.subsec_nanos() ^ d.as_secs() as u32);
    (nanos ^ (nanos >> 16) ^ std::process::id()) as u16
}
