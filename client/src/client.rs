//! The door: bytes and time in, bytes and events out.

use crate::event::Event;
use crate::foreign_traffic::ForeignTraffic;
use crate::line::Line;
use crate::mismatch::require_match;
use crate::run::Run;
use crate::session::Opening;
use crate::task::{Arming, Asking, Next, Task};
use servoid_protocol::message::{ArmFor, Command, Start, Status};
use servoid_protocol::{Hello, Rejects};
use std::time::Duration;

/// How to connect.
#[derive(Clone, Copy, Debug)]
pub struct Connect {
    /// A number that no other host of the rig will choose: by chance.
    pub session: u16,
    /// How often each request is sent before nobody is there.
    pub attempts: u32,
    /// Listen first, and send nothing while another program's run is heard.
    pub listens_first: bool,
}

/// A host in conversation with a rig.
///
/// Time comes from the driver: a duration since any moment of its choice, which never goes back.
/// A client does one thing at a time; a new task replaces the one before.
///
/// ```
/// use servoid_client::{Client, Connect, Event};
/// use servoid_protocol::{Decoder, Request};
/// use std::time::Duration;
///
/// let connect = Connect { session: 1, attempts: 12, listens_first: false };
/// let mut client = Client::connect(&connect, Duration::ZERO);
/// let bytes = client.poll_transmit().ok_or("a hello is to be sent")?;
/// let mut decoder = Decoder::new();
/// let sent: Option<Request> = bytes.iter().find_map(|&byte| decoder.push(byte));
/// assert_eq!(sent.map(|request| request.session), Some(1));
/// // Nothing comes: it is sent again at the deadline.
/// let later = client.next_deadline().ok_or("it waits for the answer")?;
/// client.handle(&[], later);
/// assert_eq!(client.poll_transmit(), Some(bytes));
/// assert_eq!(client.poll_event(), None::<Event>);
/// # Ok::<(), &str>(())
/// ```
pub struct Client {
    line: Line,
    task: Option<Box<dyn Task>>,
}

impl Client {
    /// Opens a session; [`Event::Connected`] says when it is open. A rig that another session has armed is
    /// waited for until that one's lease is over.
    pub fn connect(connect: &Connect, now: Duration) -> Self {
        let mut line = Line::new(connect.session, now);
        let mut opening = Opening::new(connect.attempts);
        let task: Box<dyn Task> = if connect.listens_first {
            Box::new(ForeignTraffic::new(opening, now))
        } else {
            opening.begin(&mut line);
            Box::new(opening)
        };
        let task = Some(task);
        Self { line, task }
    }

    /// Has the rig do something; [`Event::Answered`] says when it has.
    pub fn request(&mut self, command: Command, now: Duration) {
        self.line.now = now;
        self.line.ask(command);
        self.task = Some(Box::new(Asking));
    }

    /// Brings the rig to neutral, so that the next thing it does can be a run; [`Event::Answered`] says
    /// when it is there, and [`Client::hello`] has the timing of the pulses asked for. A rig that does not go with this program is not armed. Where it ends in
    /// [`ClientError::NoAnswer`](crate::ClientError::NoAnswer), or in
    /// [`ClientError::TimingDiffers`](crate::ClientError::TimingDiffers) once it was asked, the rig is being asked to disarm, which ends in one more event.
    pub fn arm(&mut self, asked: ArmFor, now: Duration) {
        self.line.now = now;
        match self.line.hello.as_ref().map(require_match) {
            Some(Err(error)) => self.line.fail(error),
            _ => self.task = Some(Box::new(Arming::begin(asked, &mut self.line))),
        }
    }

    /// Begins a run and follows it: [`Event::RunBegun`], an [`Event::Frame`] for each frame, and
    /// [`Event::RunEnded`]. Where it ends in [`Event::Failed`], every frame that came has come out
    /// before, and the rig is being asked to stop, which ends in one more event.
    pub fn run(&mut self, start: Start, now: Duration) {
        self.line.now = now;
        self.task = Some(Box::new(Run::begin(start, &mut self.line)));
    }

    /// Has the run end before its reference does; it is followed to its end all the same.
    pub fn stop_run(&mut self, now: Duration) {
        if let Some(task) = &mut self.task {
            task.stop();
        }
        self.handle(&[], now);
    }

    /// Lets go of the run: every frame that came comes out, the rig is asked to stop, and the answer to
    /// that is the last event.
    pub fn break_off_run(&mut self, now: Duration) {
        self.line.now = now;
        self.step(|task, line| task.break_off(line));
    }

    /// Takes `bytes` that have come by `now`, which may be none: it is to be called at the
    /// [`Client::next_deadline`] as well.
    pub fn handle(&mut self, bytes: &[u8], now: Duration) {
        self.line.now = now;
        for message in self.line.receive(bytes) {
            match self.line.take_answer(&message) {
                Some((command, answer)) => {
                    self.step(|task, line| task.on_answer(&command, Some(answer), line));
                }
                None => self.step(|task, line| {
                    task.on_message(&message, line);
                    Next::Stay
                }),
            }
        }
        if let Some(command) = self.line.insist() {
            self.step(|task, line| task.on_answer(&command, None, line));
        }
        self.step(|task, line| task.on_time(line));
    }

    fn step(&mut self, step: impl FnOnce(&mut dyn Task, &mut Line) -> Next) {
        let Some(task) = &mut self.task else {
            return;
        };
        match step(task.as_mut(), &mut self.line) {
            Next::Stay => {}
            Next::Done => self.task = None,
            Next::Then(next) => self.task = Some(next),
        }
    }

    /// Bytes to send, if there are any: to be asked for after every other call until there are none.
    pub fn poll_transmit(&mut self) -> Option<Vec<u8>> {
        self.line.outgoing.pop_front()
    }

    /// The next event, in order.
    pub fn poll_event(&mut self) -> Option<Event> {
        self.line.events.pop_front()
    }

    /// When [`Client::handle`] is to be called if no bytes come before; `None` while nothing is waited
    /// for.
    pub fn next_deadline(&self) -> Option<Duration> {
        let task = self.task.as_ref()?.deadline(&self.line);
        [task, self.line.deadline()].into_iter().flatten().min()
    }

    /// Whether the client has nothing to do.
    pub fn is_idle(&self) -> bool {
        self.task.is_none()
    }

    /// Who the rig is, once it is known.
    pub fn hello(&self) -> Option<&Hello> {
        self.line.hello.as_ref()
    }

    /// Messages of the rig that could not be read, by class.
    pub fn rejects(&self) -> Rejects {
        self.line.decoder.rejects()
    }

    /// Requests that were sent again, as their answer had not come in time.
    pub fn requests_repeated(&self) -> u32 {
        self.line.repeated
    }

    /// Frames of the run that had to be asked for again.
    pub fn frames_asked_again(&self) -> u32 {
        self.line.asked_again
    }

    /// The newest status of the rig in the run, which comes about twice a second.
    pub fn status(&self) -> Option<&Status> {
        self.line.status.as_ref()
    }
}
