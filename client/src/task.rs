//! One thing that a client is busy with; the two that take one request: asking, and arming.

use crate::error::ClientError;
use crate::event::Event;
use crate::line::Line;
use crate::mismatch::require_train;
use crate::request::{self, Answer};
use servoid_protocol::message::{ArmFor, Command, Refusal, RigMessage};
use std::time::Duration;

/// What comes after a task has heard something.
pub(crate) enum Next {
    /// It goes on.
    Stay,
    /// It is done.
    Done,
    /// Another one takes its place.
    Then(Box<dyn Task>),
}

/// One thing that a client is busy with: it hears of messages, answers and the time, and asks over the
/// [`Line`].
pub(crate) trait Task: Send {
    /// A message that is no answer.
    fn on_message(&mut self, _message: &RigMessage, _line: &mut Line) {}

    /// The answer to the request that was pending; `None` when none came.
    fn on_answer(&mut self, command: &Command, answer: Option<Answer>, line: &mut Line) -> Next;

    /// Everything that has come so far has been handed over, and [`Line::now`] is the time.
    fn on_time(&mut self, _line: &mut Line) -> Next {
        Next::Stay
    }

    /// When [`Task::on_time`] has something to do, if nothing comes before.
    fn deadline(&self, _line: &Line) -> Option<Duration> {
        None
    }

    /// Ends a run before its reference does.
    fn stop(&mut self) {}

    /// Lets go of a run: what has come of it goes to the driver, and the rig is asked to end it.
    fn break_off(&mut self, _line: &mut Line) -> Next {
        Next::Stay
    }
}

/// A single request.
pub(crate) struct Asking;

impl Task for Asking {
    fn on_answer(&mut self, command: &Command, answer: Option<Answer>, line: &mut Line) -> Next {
        let request = request::name(command);
        match answer {
            None => line.fail(ClientError::NoAnswer { request }),
            Some(Answer::Refused(refusal)) => line.fail(ClientError::Refused { request, refusal }),
            Some(answer) => line.events.push_back(Event::Answered(answer)),
        }
        Next::Done
    }
}

/// How often arming is tried where the sensor reads outside its range, and the pause in between: five
/// frames. A board that was switched on a moment ago has not read its sensor yet, and one disturbed
/// sample is no broken sensor.
const SENSOR_ATTEMPTS: u32 = 3;
const SENSOR_PAUSE: Duration = Duration::from_millis(100);

/// How often a request to arm or to start is made anew where it came too late: the line had held it back, or
/// nothing had been asked for a while.
pub(crate) const LATE_ATTEMPTS: u32 = 3;

/// Arms the rig.
pub(crate) struct Arming {
    asked: ArmFor,
    tries: u32,
    late: u32,
    pause_until: Option<Duration>,
}

impl Arming {
    pub(crate) fn begin(asked: ArmFor, line: &mut Line) -> Self {
        line.ask(asked.into());
        Self {
            asked,
            tries: 1,
            late: 0,
            pause_until: None,
        }
    }
}

impl Task for Arming {
    fn on_answer(&mut self, command: &Command, answer: Option<Answer>, line: &mut Line) -> Next {
        match (command, answer) {
            (_, Some(Answer::Refused(Refusal::SensorOutOfRange)))
                if self.tries < SENSOR_ATTEMPTS =>
            {
                self.pause_until = Some(line.now + SENSOR_PAUSE);
                Next::Stay
            }
            (_, Some(Answer::Refused(Refusal::LeaseLapsed))) if self.late < LATE_ATTEMPTS => {
                self.late += 1;
                line.ask(Command::KeepAlive);
                Next::Stay
            }
            (Command::KeepAlive, Some(Answer::Done)) => {
                line.ask(self.asked.into());
                Next::Stay
            }
            (Command::Arm(_) | Command::ArmFor(_), Some(Answer::Done)) => {
                let is_known = |hello| require_train(hello, &self.asked.train).is_ok();
                if line.hello.as_ref().is_none_or(is_known) {
                    return Asking.on_answer(command, answer, line);
                }
                line.ask(Command::Hello);
                Next::Stay
            }
            (Command::Hello, Some(Answer::Hello(hello))) => {
                line.hello = Some(hello);
                match require_train(&hello, &self.asked.train) {
                    Ok(()) => Asking.on_answer(command, Some(Answer::Done), line),
                    // A late answer to an earlier question carries no number.
                    Err(_) if self.late < LATE_ATTEMPTS => {
                        self.late += 1;
                        line.ask(Command::Hello);
                        Next::Stay
                    }
                    Err(error) => {
                        line.fail(error);
                        line.ask(Command::Disarm);
                        Next::Then(Box::new(Asking))
                    }
                }
            }
            // It may have armed all the same: only the answer may be lost.
            (_, None) => {
                Asking.on_answer(command, answer, line);
                line.ask(Command::Disarm);
                Next::Then(Box::new(Asking))
            }
            _ => Asking.on_answer(command, answer, line),
        }
    }

    fn on_time(&mut self, line: &mut Line) -> Next {
        if self.pause_until.is_some_and(|until| line.now >= until) {
            self.pause_until = None;
            self.tries += 1;
            line.ask(self.asked.into());
        }
        Next::Stay
    }

    fn deadline(&self, _line: &Line) -> Option<Duration> {
        self.pause_until
    }
}
