//! A run, from its start until every frame that the board still has is here, whatever the line does.
//!
//! Nothing here waits for an answer before it takes the next frame: a frame is handed on when it
//! arrives, and not when a lost request has been repeated often enough.
//!
//! | what happens                                  | what is done                                       |
//! |-----------------------------------------------|----------------------------------------------------|
//! | the number is that of the run before          | the next number is tried                           |
//! | a gap                                         | asked for again until it is filled or the board has forgotten it |
//! | a request or its answer is lost               | the request is repeated, which has no second effect |
//! | no frame for a while                          | the rig is asked for its status: it may be over    |
//! | the rig had heard nothing for too long        | it gets a sign of life, and is asked once more     |
//! | a frame or the end contradicts the command    | the end, with everything before it                 |
//! | the rig says that it knows nothing of the run | asked twice more, because answers may be old ones  |
//! | nothing at all for a long time                | the end, with everything that came                 |

use crate::commanded::{Commanded, Contradiction};
use crate::error::ClientError;
use crate::event::Event;
use crate::frame_order::FrameOrder;
use crate::gaps::Gaps;
use crate::line::Line;
use crate::request::Answer;
use crate::run_ending::RunEnding;
use crate::silence::Silence;
use crate::task::{Asking, LATE_ATTEMPTS, Next, Task};
use servoid_protocol::lease::SIGN_OF_LIFE_EVERY;
use servoid_protocol::message::{Activity, Command, Ended, Refusal, RigMessage, Start, Status};
use std::time::Duration;

/// Numbers that are tried beside the first one, where the rig's last run had the same.
const OTHER_NUMBERS: u32 = 3;

/// Answers in a row by which a rig does not know the run before that is believed.
const DENIALS: u32 = 3;

/// A run under way.
pub(crate) struct Run {
    start: Start,
    commanded: Commanded,
    /// What the rig said that cannot be.
    contradiction: Option<Contradiction>,
    /// Until the rig has begun it: refusals after which it was asked once more.
    starting: Option<u32>,
    order: FrameOrder,
    gaps: Gaps,
    ended: Option<Ended>,
    stop: Stop,
    denials: u32,
    silence: Silence,
    /// Every request is a sign of life.
    sign_of_life_at: Duration,
    status_asked_at: Duration,
}

#[derive(Clone, Copy, PartialEq)]
enum Stop {
    NotWanted,
    Wanted,
    Done,
}

impl Run {
    /// Has the rig begin a run.
    pub(crate) fn begin(start: Start, line: &mut Line) -> Self {
        let history_frames = line.hello.map_or(0, |hello| hello.history_frames);
        (line.status, line.asked_again) = (None, 0);
        line.ask(Command::Start(start));
        Self {
            start,
            commanded: Commanded::new(start, line.armed.map(|armed| armed.arm.neutral)),
            contradiction: None,
            starting: Some(0),
            order: FrameOrder::new(start.run),
            gaps: Gaps::new(history_frames),
            ended: None,
            stop: Stop::NotWanted,
            denials: 0,
            silence: Silence::since(line.now),
            sign_of_life_at: line.now,
            status_asked_at: line.now,
        }
    }

    fn on_started(&mut self, command: &Command, answer: Option<Answer>, line: &mut Line) -> Next {
        let Some(refusals) = self.starting else {
            return Next::Stay;
        };
        match answer {
            Some(Answer::Done) if *command == Command::KeepAlive => {
                line.ask(Command::Start(self.start));
                Next::Stay
            }
            Some(Answer::Done) => {
                self.starting = None;
                self.silence = Silence::since(line.now);
                let run = self.start.run;
                line.events.push_back(Event::RunBegun { run });
                Next::Stay
            }
            Some(Answer::Refused(Refusal::LeaseLapsed)) if refusals < LATE_ATTEMPTS => {
                self.starting = Some(refusals + 1);
                line.ask(Command::KeepAlive);
                Next::Stay
            }
            Some(Answer::Refused(Refusal::RunRepeated)) if refusals < OTHER_NUMBERS => {
                let stop = self.stop;
                let run = self.start.run.wrapping_add(1);
                *self = Self::begin(Start { run, ..self.start }, line);
                self.stop = stop;
                self.starting = Some(refusals + 1);
                Next::Stay
            }
            // The rig may have begun it all the same: only the answer may be lost.
            _ => {
                Asking.on_answer(command, answer, line);
                self.ask_to_stop(line)
            }
        }
    }

    fn on_status(&mut self, status: &Status, line: &mut Line) -> Next {
        line.status = Some(*status);
        match status.activity {
            Activity::Ended(ended) if ended.run == self.start.run => self.note_end(&ended, line),
            Activity::Running { run, .. } if run == self.start.run => {}
            _ => {
                self.denials += 1;
                return match self.denials >= DENIALS {
                    true => self.fail(ClientError::RunForgotten, line),
                    false => Next::Stay,
                };
            }
        }
        self.denials = 0;
        Next::Stay
    }

    fn note_end(&mut self, ended: &Ended, line: &Line) {
        if ended.run != self.start.run || self.ended.is_some() {
            return;
        }
        let newest = self.order.newest();
        self.contradiction = self
            .contradiction
            .or(self.commanded.contradicts_end(ended, newest));
        if self.contradiction.is_none() {
            self.ended = Some(*ended);
            self.silence.progress_at = line.now;
        }
    }

    fn fail(&mut self, error: ClientError, line: &mut Line) -> Next {
        self.release_over_gaps(line);
        line.fail(error);
        self.ask_to_stop(line)
    }

    fn ask_to_stop(&self, line: &mut Line) -> Next {
        let run = self.start.run;
        line.ask(Command::Stop { run });
        Next::Then(Box::new(Asking))
    }

    /// Hands on the frames that are next in order.
    fn release(&mut self, line: &mut Line) {
        let ready = std::iter::from_fn(|| self.order.pop_ready());
        line.events.extend(ready.map(Event::Frame));
    }

    /// Hands on all that has come; missing frames before it are given up.
    fn release_over_gaps(&mut self, line: &mut Line) {
        self.release(line);
        while self.order.give_up_before(self.end_so_far()) {
            self.release(line);
        }
    }

    /// Gives up the first gap if the board cannot fill it any more; says whether it did.
    fn give_up_hopeless(&mut self) -> bool {
        let (end, is_over) = (self.end_so_far(), self.ended.is_some());
        let gaps = &self.gaps;
        gaps.give_up_hopeless(&mut self.order, end, is_over)
    }

    /// The end of the run, where nothing of it can still be had.
    fn everything_is_here(&self) -> Option<Ended> {
        self.ended.filter(|ended| {
            self.order.position() >= u32::from(ended.frames)
                || self.order.lacks_only_what_the_board_lost(ended)
        })
    }

    /// One past the last frame that there must have been.
    fn end_so_far(&self) -> u32 {
        self.ended
            .map_or(self.order.newest(), |ended| ended.frames.into())
    }

    /// The requests to come and when, the most urgent first.
    fn agenda(&self, line: &Line) -> [Option<(Duration, Command)>; 4] {
        let run = self.start.run;
        let (running, silent) = (self.ended.is_none(), line.pending().is_none());
        let stopping = matches!(line.pending(), Some(Command::Stop { .. }));
        let stop = (Duration::ZERO, Command::Stop { run });
        let question = self.silence.question_at(self.status_asked_at);
        let sign_of_life = self.sign_of_life_at + SIGN_OF_LIFE_EVERY;
        let frame_at = self.silence.frame_at;
        let gap = self.gaps.due(&self.order, self.end_so_far(), frame_at);
        let resend = gap.and_then(|(at, gap)| {
            let (first, count) = (gap.start.try_into().ok()?, gap.len().try_into().ok()?);
            Some((at, Command::Resend { run, first, count }))
        });
        [
            (running && self.stop == Stop::Wanted && !stopping).then_some(stop),
            (running && silent).then_some((question, Command::Status)),
            resend.filter(|_| silent),
            (running && silent).then_some((sign_of_life, Command::Status)),
        ]
    }

    fn ask(&mut self, command: Command, line: &mut Line) {
        match command {
            Command::Status => self.status_asked_at = line.now,
            Command::Resend { first, count, .. } => {
                line.asked_again += u32::from(count);
                let first = u32::from(first);
                self.gaps.asked(first..first + u32::from(count));
            }
            _ => {}
        }
        self.sign_of_life_at = line.now;
        line.ask(command);
    }
}

impl Task for Run {
    fn on_message(&mut self, message: &RigMessage, line: &mut Line) {
        self.silence.message_at = line.now;
        match message {
            RigMessage::Frame(frame) => {
                self.silence.frame_at = line.now;
                if frame.run != self.start.run || self.contradiction.is_some() {
                    return;
                }
                self.contradiction = self.commanded.contradicts_frame(frame);
                if self.contradiction.is_none() && self.order.insert(*frame) {
                    self.silence.progress_at = line.now;
                    // Whoever sends new frames knows the run: what denied it was older.
                    self.denials = 0;
                }
            }
            RigMessage::Ended(ended) => self.note_end(ended, line),
            _ => {}
        }
    }

    fn on_answer(&mut self, command: &Command, answer: Option<Answer>, line: &mut Line) -> Next {
        if self.starting.is_some() {
            return self.on_started(command, answer, line);
        }
        let Some(answer) = answer else {
            return Next::Stay; // what is still due is asked for anew
        };
        self.silence.message_at = line.now;
        match (command, answer) {
            (_, Answer::Status(status)) => return self.on_status(&status, line),
            (Command::Stop { .. }, Answer::Done) => self.stop = Stop::Done,
            (Command::Resend { .. }, Answer::Done) => self.gaps.answered(line.now),
            // The session is another's, or the rig has been reset and has none.
            (_, Answer::Refused(Refusal::UnknownSession | Refusal::UnknownRun)) => {
                return self.fail(ClientError::RunForgotten, line);
            }
            _ => {}
        }
        self.denials = 0;
        Next::Stay
    }

    fn on_time(&mut self, line: &mut Line) -> Next {
        if self.starting.is_some() {
            return Next::Stay;
        }
        if let Some(contradiction) = self.contradiction {
            return self.fail(ClientError::Contradiction(contradiction), line);
        }
        self.release(line);
        while self.everything_is_here().is_none() && self.give_up_hopeless() {
            self.release(line);
        }
        if let Some(ended) = self.everything_is_here() {
            self.release_over_gaps(line);
            let ending = RunEnding::of(&ended, &self.order);
            line.events.push_back(Event::RunEnded(ending));
            return Next::Done;
        }
        if let Some(error) = self.silence.lasts_too_long(line.now) {
            return self.fail(error, line);
        }
        let agenda = self.agenda(line).into_iter().flatten();
        if let Some((_, command)) = agenda.clone().find(|(at, _)| *at <= line.now) {
            self.ask(command, line);
        }
        Next::Stay
    }

    fn deadline(&self, line: &Line) -> Option<Duration> {
        if self.starting.is_some() {
            return None;
        }
        let agenda = self.agenda(line).into_iter().flatten();
        let silence = self.silence.deadline();
        Some(agenda.map(|(at, _)| at).fold(silence, Duration::min))
    }

    fn stop(&mut self) {
        if self.stop == Stop::NotWanted {
            self.stop = Stop::Wanted;
        }
    }

    fn break_off(&mut self, line: &mut Line) -> Next {
        self.release_over_gaps(line);
        self.ask_to_stop(line)
    }
}
