//! One thing that a client is busy with.

use crate::error::ClientError;
use crate::event::Event;
use crate::line::Line;
use crate::request::{self, Answer};
use servoid_protocol::message::{Command, RigMessage};
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
