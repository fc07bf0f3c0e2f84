//! Opening a session.

use crate::error::ClientError;
use crate::event::Event;
use crate::line::Line;
use crate::request::Answer;
use crate::task::{Next, Task};
use servoid_protocol::Hello;
use servoid_protocol::lease::ABANDONED_RUN_IS_OVER;
use servoid_protocol::message::Command;
use servoid_protocol::schema::SCHEMA_HASH;
use std::time::Duration;

/// How often a session is opened anew where the rig denies it.
const SESSION_ATTEMPTS: u32 = 5;

/// Between two of these attempts: a run's frames need the line as well.
const SESSION_PAUSE: Duration = Duration::from_millis(100);

/// Opens a session, and waits for the end of the lease of another one that holds the rig.
///
/// A hello may be a late one that got stuck on the way, and a rig that another session holds says hello
/// as well. The session is open when the rig has carried out a request of it.
#[derive(Clone, Copy)]
pub(crate) struct Opening {
    attempts: u32,
    tries: u32,
    begin: Duration,
    step: Step,
}

#[derive(Clone, Copy)]
enum Step {
    Hello,
    KeepAlive(Hello),
    Pause { until: Duration },
}

impl Opening {
    /// Each request is sent `attempts` times before nobody is there.
    pub(crate) fn new(attempts: u32) -> Self {
        Self {
            attempts,
            tries: 0,
            begin: Duration::ZERO,
            step: Step::Hello,
        }
    }

    pub(crate) fn begin(&mut self, line: &mut Line) {
        self.begin = line.now;
        self.say_hello(line);
    }

    fn say_hello(&mut self, line: &mut Line) {
        self.step = Step::Hello;
        line.ask_patiently(Command::Hello, self.attempts);
    }

    fn try_again(&mut self, line: &mut Line) -> Next {
        self.tries += 1;
        // A session that nobody keeps alive gives the rig free within its lease.
        let waited = line.now.saturating_sub(self.begin);
        if self.tries >= SESSION_ATTEMPTS && waited >= ABANDONED_RUN_IS_OVER {
            line.fail(ClientError::RunOfAnother);
            return Next::Done;
        }
        let until = line.now + SESSION_PAUSE;
        self.step = Step::Pause { until };
        Next::Stay
    }
}

fn connected(hello: Hello, line: &mut Line) -> Next {
    line.hello = Some(hello);
    line.events.push_back(Event::Connected(hello));
    Next::Done
}

impl Task for Opening {
    fn on_answer(&mut self, _command: &Command, answer: Option<Answer>, line: &mut Line) -> Next {
        match (self.step, answer) {
            (_, None) => {
                let bytes = line.bytes_received;
                line.fail(ClientError::NobodyThere { bytes });
                Next::Done
            }
            // With other messages the same bytes could ask for anything: a hello has to do.
            (Step::Hello, Some(Answer::Hello(hello))) if hello.schema_hash != SCHEMA_HASH => {
                connected(hello, line)
            }
            (Step::Hello, Some(Answer::Hello(hello))) => {
                self.step = Step::KeepAlive(hello);
                line.ask_patiently(Command::KeepAlive, self.attempts);
                Next::Stay
            }
            (Step::KeepAlive(hello), Some(Answer::Done)) => connected(hello, line),
            (Step::Hello, Some(_)) => {
                line.change_session(); // the rig knows an older session of that number
                self.try_again(line)
            }
            _ => self.try_again(line),
        }
    }

    fn on_time(&mut self, line: &mut Line) -> Next {
        if matches!(self.step, Step::Pause { until } if line.now >= until) {
            self.say_hello(line);
        }
        Next::Stay
    }

    fn deadline(&self, _line: &Line) -> Option<Duration> {
        match self.step {
            Step::Pause { until } => Some(until),
            Step::Hello | Step::KeepAlive(_) => None,
        }
    }
}
