//! A rig at the other end of a port: asks, and waits for the answers.

use super::driver::Driver;
use super::talk_error::TalkError;
use crate::instrument::port::{Port, is_simulated};
use servoid_client::{Answer, Client, ClientError, Connect, Event};
use servoid_protocol::loopback::{Loopback, LoopbackFrame, Vitals};
use servoid_protocol::message::{ArmFor, Command, Start, Status};
use servoid_protocol::schema::SCHEMA_HASH;
use servoid_protocol::{Health, Hello, Rejects};
use std::time::Duration;

/// A board that has just been plugged in needs a moment until it answers (bootloader, USB bridge).
const HELLO_ATTEMPTS: u32 = 12;

/// A look at a port that may well be something else.
const PROBE_ATTEMPTS: u32 = 3;

/// A rig at the other end of a port.
pub struct RigClient {
    driver: Driver,
    hello: Hello,
}

impl RigClient {
    /// Opens a session on a port; `address` is what error texts call it. A rig that another session
    /// has armed is waited for until that one's lease is over.
    ///
    /// # Errors
    /// [`TalkError::Silent`] or [`TalkError::Garbled`] when no rig is there, and
    /// [`ClientError::RunOfAnother`] when another session goes on.
    pub fn connect(port: Box<dyn Port>, address: &str) -> Result<Self, TalkError> {
        Self::connect_as(port, address, session_number())
    }

    /// [`RigClient::connect`] with a session number of the caller's: equal numbers on equal ports
    /// give equal bytes.
    pub fn connect_as(port: Box<dyn Port>, address: &str, session: u16) -> Result<Self, TalkError> {
        let connect = Connect {
            session,
            attempts: HELLO_ATTEMPTS,
            listens_first: false,
        };
        Self::open(port, address, &connect)
    }

    /// [`RigClient::connect`], but nothing is sent where frames of a run are heard.
    pub fn connect_beside(port: Box<dyn Port>, address: &str) -> Result<Self, TalkError> {
        Self::open_beside(port, address, HELLO_ATTEMPTS)
    }

    /// [`RigClient::connect_beside`] without patience: to find out quickly which of many ports is a
    /// rig.
    pub fn probe(port: Box<dyn Port>, address: &str) -> Result<Self, TalkError> {
        Self::open_beside(port, address, PROBE_ATTEMPTS)
    }

    fn open_beside(port: Box<dyn Port>, address: &str, attempts: u32) -> Result<Self, TalkError> {
        let connect = Connect {
            session: session_number(),
            attempts,
            // A simulated rig belongs to whoever opened it.
            listens_first: !is_simulated(address),
        };
        Self::open(port, address, &connect)
    }

    fn open(port: Box<dyn Port>, address: &str, connect: &Connect) -> Result<Self, TalkError> {
        let client = Client::connect(connect, port.now());
        let mut driver = Driver { port, client };
        let nobody = |bytes| match bytes {
            0 => TalkError::Silent(address.to_owned()),
            _ => TalkError::Garbled(address.to_owned(), bytes),
        };
        loop {
            match driver.next_event(Duration::MAX)? {
                Some(Event::Connected(hello)) => return Ok(Self { driver, hello }),
                Some(Event::Failed(ClientError::NobodyThere { bytes })) => {
                    return Err(nobody(bytes));
                }
                Some(Event::Failed(error)) => return Err(error.into()),
                Some(_) => {}
                None => return Err(nobody(0)),
            }
        }
    }

    /// Who the rig is.
    pub fn hello(&self) -> &Hello {
        &self.hello
    }

    /// Whether the rig was built for the messages of this program.
    pub fn has_equal_schema(&self) -> bool {
        self.hello.schema_hash == SCHEMA_HASH
    }

    /// Messages of the rig that could not be read, by class.
    pub fn rejects(&self) -> Rejects {
        self.driver.client.rejects()
    }

    /// The port's clock.
    pub fn now(&self) -> Duration {
        self.driver.port.now()
    }

    /// Whether the rig's time stands still while nobody listens to it.
    pub fn is_paced_by_reader(&self) -> bool {
        self.driver.port.is_paced_by_reader()
    }

    /// How the rig is.
    ///
    /// # Errors
    /// When it does not answer.
    pub fn status(&mut self) -> Result<Status, TalkError> {
        self.driver.client.request(Command::Status, self.now());
        match self.answer()? {
            Answer::Status(status) => Ok(status),
            _ => Err(no_answer()),
        }
    }

    /// The health of the rig's board.
    ///
    /// # Errors
    /// When it does not answer.
    pub fn health(&mut self) -> Result<Health, TalkError> {
        self.driver.client.request(Command::Health, self.now());
        match self.answer()? {
            Answer::Health(health) => Ok(health),
            _ => Err(no_answer()),
        }
    }

    /// What the rig's board measures of its processor.
    ///
    /// # Errors
    /// When it does not answer.
    pub fn vitals(&mut self) -> Result<Vitals, TalkError> {
        self.driver.client.request(Command::Vitals, self.now());
        match self.answer()? {
            Answer::Vitals(vitals) => Ok(vitals),
            _ => Err(no_answer()),
        }
    }

    /// Has a board test itself, and gives its newest frame.
    ///
    /// # Errors
    /// When it refuses, or does not answer.
    pub fn loopback(&mut self, loopback: Loopback) -> Result<LoopbackFrame, TalkError> {
        self.driver
            .client
            .request(Command::Loopback(loopback), self.now());
        match self.answer()? {
            Answer::Loopback(frame) => Ok(frame),
            _ => Err(no_answer()),
        }
    }

    /// Lets `time` pass.
    ///
    /// # Errors
    /// When the line is gone.
    pub fn pause(&mut self, time: Duration) -> Result<(), TalkError> {
        self.driver.pause(time)
    }

    /// Requests that were sent again, as their answer had not come in time.
    pub fn requests_repeated(&self) -> u32 {
        self.driver.client.requests_repeated()
    }

    /// Has the rig do something; returns when it has done it.
    ///
    /// # Errors
    /// When it refuses, or does not answer.
    pub fn request(&mut self, command: Command) -> Result<(), TalkError> {
        self.driver.client.request(command, self.now());
        self.answer().map(|_done| ())
    }

    /// Brings the rig to neutral; returns when it is there.
    ///
    /// # Errors
    /// When it does not go with this program, refuses, or does not answer.
    pub fn arm(&mut self, asked: ArmFor) -> Result<(), TalkError> {
        self.driver.client.arm(asked, self.now());
        let armed = self.answer();
        // It states the timing of the pulses that it is armed for.
        if let Some(hello) = self.driver.client.hello() {
            self.hello = *hello;
        }
        if !self.driver.client.is_idle() {
            let _the_disarming_is_best_effort = self.answer();
        }
        armed.map(|_done| ())
    }

    fn answer(&mut self) -> Result<Answer, TalkError> {
        while let Some(event) = self.driver.next_event(Duration::MAX)? {
            match event {
                Event::Answered(answer) => return Ok(answer),
                Event::Failed(error) => return Err(error.into()),
                _ => {}
            }
        }
        Err(no_answer())
    }

    /// Has the rig begin a run, which [`RigClient::next_event`] follows.
    pub(super) fn begin_run(&mut self, start: Start) {
        self.driver.client.run(start, self.now());
    }

    /// Has the run end before its reference does.
    pub(super) fn stop_run(&mut self) {
        self.driver.client.stop_run(self.now());
    }

    /// What happens next in the run, waiting up to `timeout` for it.
    pub(super) fn next_event(&mut self, timeout: Duration) -> Result<Option<Event>, TalkError> {
        self.driver.next_event(timeout)
    }

    /// Lets go of a run that went wrong, so that the servo returns to neutral; hands the remaining events to
    /// `rest`. Where the line is gone nobody can be asked, and the lease brings the servo there.
    pub(super) fn leave_run(&mut self, line_is_gone: bool, mut rest: impl FnMut(Event, &Client)) {
        self.driver.client.break_off_run(self.now());
        while let Some(event) = self.driver.client.poll_event() {
            rest(event, &self.driver.client);
        }
        if !line_is_gone {
            let _what_went_wrong_before_is_reported = self.answer();
        }
    }

    /// The conversation, for what it knows of the run.
    pub(super) fn conversation(&self) -> &Client {
        &self.driver.client
    }
}

fn no_answer() -> TalkError {
    let request = "answer";
    ClientError::NoAnswer { request }.into()
}

/// A number that two programs on one rig will hardly both choose. It need not be random in any
/// stronger sense: it keeps sessions apart, it does not protect them.
pub fn session_number() -> u16 {
    let now = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH);
    let nanos = now.map_or(0, |d| d.subsec_nanos() ^ d.as_secs() as u32);
    (nanos ^ (nanos >> 16) ^ std::process::id()) as u16
}
