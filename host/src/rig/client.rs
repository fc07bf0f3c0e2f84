//! Requests that arrive, answers that belong to them.

use super::mismatch::mismatches;
pub use super::talk_error::TalkError;
use crate::port::Port;
use servoid_protocol::hello::SCHEMA_HASH;
use servoid_protocol::message::{Command, Outcome, Refusal, Request, RigMessage, Status};
use servoid_protocol::{Decoder, Hello, Rejects, framing};
use std::collections::VecDeque;
use std::time::Duration;

/// How long an answer may take before the request is said again. The rig answers within a frame
/// (20 ms), behind at most 512 bytes that wait for the line (45 ms at 115200 baud).
const ANSWER_TIMEOUT: Duration = Duration::from_millis(250);

/// How often a request is said. On the worst line that has to do, with 5 % of the frames lost and 5 %
/// of the others corrupted each way, fewer than one capture of 100 requests in a million fails for
/// want of an answer; the test at the end of this file has the arithmetic.
const ATTEMPTS: u32 = 11;

/// A board that has just been plugged in needs a moment until it answers (bootloader, USB bridge).
const HELLO_ATTEMPTS: u32 = 12;

/// How often a session is opened anew where the rig denies it.
const SESSION_ATTEMPTS: u32 = 5;

/// A look at a port that may well be something else.
const PROBE_ATTEMPTS: u32 = 3;

/// A run sends a frame every 20 ms: three times that lets one be lost.
const FRAMES_COME: Duration = Duration::from_millis(60);

/// A run whose frames have come does not come to its end before this much silence.
const FRAMES_STOP: Duration = Duration::from_millis(200);

/// Longer than the two seconds for which a run goes on that nobody follows.
const RUN_IS_FOLLOWED: Duration = Duration::from_millis(2_500);

/// A rig at the other end of a port.
pub struct RigClient {
    talk: Conversation,
    hello: Hello,
}

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
        Self::open(port, address, session_number(), HELLO_ATTEMPTS)
    }

    /// [`RigClient::connect`] with a session number of the caller's: equal numbers on equal ports
    /// give equal bytes.
    ///
    /// # Errors
    /// As [`RigClient::connect`].
    pub fn connect_as(port: Box<dyn Port>, address: &str, session: u16) -> Result<Self, TalkError> {
        Self::open(port, address, session, HELLO_ATTEMPTS)
    }

    /// [`RigClient::connect`], but where a run is under way nothing is said: a new session would take
    /// the rig from the program that follows the run. What is heard of a run is its frames, so on a
    /// line that brings them to one listener only, a run is not noticed.
    ///
    /// # Errors
    /// As [`RigClient::connect`], and [`TalkError::RunOfAnother`].
    pub fn connect_beside(port: Box<dyn Port>, address: &str) -> Result<Self, TalkError> {
        Self::open_beside(port, address, HELLO_ATTEMPTS)
    }

    /// [`RigClient::connect_beside`] without patience: to find out quickly which of many ports is a
    /// rig.
    ///
    /// # Errors
    /// As [`RigClient::connect_beside`].
    pub fn probe(port: Box<dyn Port>, address: &str) -> Result<Self, TalkError> {
        Self::open_beside(port, address, PROBE_ATTEMPTS)
    }

    fn open_beside(
        mut port: Box<dyn Port>,
        address: &str,
        attempts: u32,
    ) -> Result<Self, TalkError> {
        // A simulated rig belongs to whoever opened it.
        if !crate::port::is_simulated(address) && hears_a_run(port.as_mut())? {
            return Err(TalkError::RunOfAnother);
        }
        Self::open(port, address, session_number(), attempts)
    }

    fn open(
        port: Box<dyn Port>,
        address: &str,
        session: u16,
        attempts: u32,
    ) -> Result<Self, TalkError> {
        let mut talk = Conversation {
            port,
            decoder: Decoder::new(),
            session,
            next_id: 0,
            bytes_received: 0,
            inbox: VecDeque::new(),
        };
        let nobody = |talk: &Conversation| {
            let port = address.to_owned();
            match talk.bytes_received {
                0 => TalkError::Silent { port },
                bytes => TalkError::Garbled { port, bytes },
            }
        };
        // A hello may be an old one that had got stuck on the way: the session is open when the rig
        // has answered to a request of it.
        for _ in 0..SESSION_ATTEMPTS {
            let hello = match talk.ask(Command::Hello, attempts)? {
                Some(Answer::Hello(hello)) => hello,
                Some(_) => {
                    talk.session = talk.session.wrapping_add(1);
                    continue;
                }
                None => return Err(nobody(&talk)),
            };
            // With other messages the same bytes could ask for anything: a hello has to do.
            if hello.schema_hash != SCHEMA_HASH {
                return Ok(Self { talk, hello });
            }
            match talk.ask(Command::KeepAlive, attempts)? {
                Some(Answer::Done) => return Ok(Self { talk, hello }),
                Some(_) => continue,
                None => return Err(nobody(&talk)),
            }
        }
        let request = name(&Command::Hello);
        let refusal = Refusal::UnknownSession;
        Err(TalkError::Refused { request, refusal })
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

    /// Whether the rig's time stands still while nobody listens to it.
    #[must_use]
    pub fn is_paced_by_reader(&self) -> bool {
        self.talk.port.is_paced_by_reader()
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

    /// Refuses to go on with a rig that differs in anything a recording depends on (see
    /// [`mismatches`]): with an equal schema, its timing.
    ///
    /// # Errors
    /// [`TalkError::SchemaDiffers`], [`TalkError::TimingDiffers`].
    pub fn require_match(&self) -> Result<(), TalkError> {
        self.require_equal_schema()?;
        match mismatches(&self.hello).into_iter().next() {
            None => Ok(()),
            Some(first) => Err(TalkError::TimingDiffers {
                field: first.field,
                rig: first.rig,
                host: first.servoid,
                meaning: first.meaning,
            }),
        }
    }

    /// How the rig is.
    ///
    /// # Errors
    /// When it does not answer.
    pub fn status(&mut self) -> Result<Status, TalkError> {
        match self.ask(Command::Status)? {
            Answer::Status(status) => Ok(status),
            _ => Err(TalkError::NoAnswer {
                request: name(&Command::Status),
            }),
        }
    }

    /// Has the rig do something; returns when it has said that it did.
    ///
    /// # Errors
    /// When it refuses, or does not answer.
    pub fn request(&mut self, command: Command) -> Result<(), TalkError> {
        self.ask(command).map(|_done| ())
    }

    fn ask(&mut self, command: Command) -> Result<Answer, TalkError> {
        let request = name(&command);
        match self.talk.ask(command, ATTEMPTS)? {
            Some(Answer::Refused(refusal)) => Err(TalkError::Refused { request, refusal }),
            Some(answer) => Ok(answer),
            None => Err(TalkError::NoAnswer { request }),
        }
    }

    /// Says a new request and does not wait: [`Asked::answer_in`] knows its answer among what
    /// [`RigClient::receive`] brings. It overtakes every request before it: the rig answers those
    /// no more.
    ///
    /// # Errors
    /// When the stream broke.
    pub fn say(&mut self, command: Command) -> Result<Asked, TalkError> {
        self.talk.say(command)
    }

    /// Says the newest request again if its answer is overdue; `false` when that has been done often
    /// enough.
    ///
    /// # Errors
    /// When the stream broke.
    pub fn insist(&mut self, asked: &mut Asked) -> Result<bool, TalkError> {
        if self.now().saturating_sub(asked.said_at) < ANSWER_TIMEOUT {
            return Ok(true);
        }
        if asked.said >= ATTEMPTS {
            return Ok(false);
        }
        self.talk.say_again(asked).map(|()| true)
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
    fn say(&mut self, command: Command) -> Result<Asked, TalkError> {
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

    fn say_again(&mut self, asked: &mut Asked) -> Result<(), TalkError> {
        let mut buffer = [0; framing::MAX_WIRE];
        let wire = framing::encode(&asked.request, &mut buffer)
            .map_err(|e| std::io::Error::other(e.to_string()))?;
        self.port.write_all(wire)?;
        asked.said_at = self.port.now();
        asked.said += 1;
        Ok(())
    }

    /// Says `command` until its answer comes; the rest stays in the inbox in its order. `None` when
    /// no answer came.
    fn ask(&mut self, command: Command, attempts: u32) -> Result<Option<Answer>, TalkError> {
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

/// Whether frames of a run come, and go on coming for longer than a lease: a run that nobody follows
/// any more ends by itself.
fn hears_a_run(port: &mut dyn Port) -> std::io::Result<bool> {
    let (mut decoder, mut buffer) = (Decoder::new(), [0; 512]);
    let begin = port.now();
    let mut quiet_at = begin + FRAMES_COME;
    while port.now() < quiet_at {
        if port.now() >= begin + RUN_IS_FOLLOWED {
            return Ok(true);
        }
        let count = port.read(&mut buffer, quiet_at.saturating_sub(port.now()))?;
        let messages = buffer.iter().take(count);
        for message in messages.filter_map(|&byte| decoder.push::<RigMessage>(byte)) {
            if matches!(message, RigMessage::Frame(_)) {
                quiet_at = port.now() + FRAMES_STOP;
            }
        }
    }
    Ok(false)
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
