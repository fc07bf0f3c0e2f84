//! A rig at the other end of a port.

use super::conversation::{ATTEMPTS, Conversation};
pub use super::conversation::{Answer, Asked};
use super::mismatch::mismatches;
pub use super::talk_error::TalkError;
use crate::instrument::port::Port;
use crate::instrument::rig::foreign_traffic::{RUN_IS_FOLLOWED, hears_a_run};
use servoid_protocol::hello::SCHEMA_HASH;
use servoid_protocol::message::{Command, RigMessage, Status};
use servoid_protocol::{Hello, Rejects};
use std::time::Duration;

/// A board that has just been plugged in needs a moment until it answers (bootloader, USB bridge).
const HELLO_ATTEMPTS: u32 = 12;

/// How often a session is opened anew where the rig denies it.
const SESSION_ATTEMPTS: u32 = 5;

/// Between two of these attempts: a run's frames need the line as well.
const SESSION_PAUSE: Duration = Duration::from_millis(100);

/// A look at a port that may well be something else.
const PROBE_ATTEMPTS: u32 = 3;

/// A rig at the other end of a port.
pub struct RigClient {
    talk: Conversation,
    hello: Hello,
}

impl RigClient {
    /// Opens a session on a port; `address` is what error texts call it. A rig that another session
    /// has armed is waited for until that one's lease is over.
    ///
    /// # Errors
    /// [`TalkError::Silent`] or [`TalkError::Garbled`] when no rig is there, and
    /// [`TalkError::RunOfAnother`] when another session goes on.
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

    /// [`RigClient::connect`], but where frames of a run are heard nothing is said. The rig would
    /// keep to its session anyway; but whatever is said on a line that two programs share may meet
    /// what the other one says.
    ///
    /// # Errors
    /// As [`RigClient::connect`].
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
        if !crate::instrument::port::is_simulated(address) && hears_a_run(port.as_mut())? {
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
        let mut talk = Conversation::new(port, session);
        let nobody = |talk: &Conversation| {
            let port = address.to_owned();
            match talk.bytes_received {
                0 => TalkError::Silent { port },
                bytes => TalkError::Garbled { port, bytes },
            }
        };
        // A hello may be an old one that had got stuck on the way, and a rig that another session holds
        // says hello as well: the session is open when the rig has answered to a request of it.
        let (begin, mut tries) = (talk.port.now(), 0);
        loop {
            match talk.ask(Command::Hello, attempts)? {
                // With other messages the same bytes could ask for anything: a hello has to do.
                Some(Answer::Hello(hello)) if hello.schema_hash != SCHEMA_HASH => {
                    return Ok(Self { talk, hello });
                }
                Some(Answer::Hello(hello)) => match talk.ask(Command::KeepAlive, attempts)? {
                    Some(Answer::Done) => {
                        // What came before is not of this session.
                        talk.inbox.clear();
                        return Ok(Self { talk, hello });
                    }
                    Some(_) => {}
                    None => return Err(nobody(&talk)),
                },
                // An older session of that number.
                Some(_) => talk.session = talk.session.wrapping_add(1),
                None => return Err(nobody(&talk)),
            }
            tries += 1;
            // A session that nobody follows any more gives the rig free within its lease.
            let waited = talk.port.now().saturating_sub(begin);
            if tries >= SESSION_ATTEMPTS && waited >= RUN_IS_FOLLOWED {
                return Err(TalkError::RunOfAnother);
            }
            talk.pause(SESSION_PAUSE)?;
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
        self.talk.insist(asked)
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

/// A number that two programs on one rig will hardly both choose. It need not be random in any
/// stronger sense: it tells sessions apart, it does not protect them.
#[must_use]
pub fn session_number() -> u16 {
    let now = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH);
    let nanos = now.map_or(0, |d| d.subsec_nanos() ^ d.as_secs() as u32);
    (nanos ^ (nanos >> 16) ^ std::process::id()) as u16
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
