//! Following a run: every frame that the board still has is got, whatever the line does.
//!
//! Nothing here waits for an answer. Requests go out, and what comes in is looked at as it comes, so
//! that a frame is written when it arrives and not when a lost request has been said often enough.
//!
//! | what happens                      | what is done                                                   |
//! |-----------------------------------|----------------------------------------------------------------|
//! | a gap                             | asked for again until it is filled or the board has forgotten it |
//! | a request or its answer is lost   | the request is said again; a repeated request has no second effect |
//! | no frame for a while              | the rig is asked what it is doing: it may be over              |
//! | the rig says that it knows nothing of the run | asked once more, because the answer may be an old one |
//! | nothing at all for a long time    | the end, with everything that came                             |

mod ending;
mod gaps;

use super::capture::{CaptureError, Progress, StopReason};
use super::client::{Answer, Asked, RigClient, TalkError};
use super::run::RunAssembly;
use crate::data::recording::RecordingWriter;
use gaps::Resend;
use servoid_protocol::message::{Activity, Command, Ended, Refusal, RigMessage, Start, Status};
use std::time::Duration;

/// A frame waits for so long at most before it is written. A short wait costs next to nothing: a
/// port returns as soon as bytes come.
const LISTEN: Duration = Duration::from_millis(5);

/// A sign of life is given four times in a lease, which is two seconds: by asking the rig how it is,
/// which says at the same time how full its memory for frames was.
const SIGN_OF_LIFE_EVERY: Duration = Duration::from_millis(500);

/// Without a frame for this long, the rig is asked whether the run is over, and again every time.
const QUIET: Duration = Duration::from_millis(200);

/// Nothing readable for this long, and the rig is taken for gone. The board's memory is five seconds
/// long: waiting twice that lets a plug that was pulled be put back without losing anything.
const SILENT: Duration = Duration::from_secs(10);

/// The rig answers, and no frame has come that was not there already.
const STANDS_STILL: Duration = Duration::from_secs(20);

/// Answers in a row by which a rig does not know the run before that is believed.
const DENIALS: u32 = 3;

/// A run under way.
pub(super) struct RunFollower<'a> {
    client: &'a mut RigClient,
    start: Start,
    assembly: RunAssembly,
    ended: Option<Ended>,
    /// The one request that waits for its answer.
    asked: Option<Asked>,
    begun: bool,
    /// One past the newest frame that is in the file.
    written: u32,
    stop: Stop,
    /// What the rig last said of itself.
    status: Option<Status>,
    denials: u32,
    asked_again: u32,
    resend: Option<Resend>,
    heard_at: Duration,
    frame_at: Duration,
    progress_at: Duration,
    sign_of_life_at: Duration,
    status_at: Duration,
}

#[derive(Clone, Debug, PartialEq)]
enum Stop {
    NotWanted,
    Wanted(StopReason),
    Done(StopReason),
}

impl<'a> RunFollower<'a> {
    pub(super) fn new(client: &'a mut RigClient, start: Start) -> Self {
        let now = client.now();
        Self {
            client,
            start,
            assembly: RunAssembly::new(start.run),
            ended: None,
            asked: None,
            begun: false,
            written: 0,
            stop: Stop::NotWanted,
            status: None,
            denials: 0,
            asked_again: 0,
            resend: None,
            heard_at: now,
            frame_at: now,
            progress_at: now,
            sign_of_life_at: now,
            status_at: now,
        }
    }

    pub(super) fn rejects(&self) -> u32 {
        self.client.rejects().total()
    }

    pub(super) fn asked_again(&self) -> u32 {
        self.asked_again
    }

    /// Whether the rig has said that the run is under way.
    pub(super) fn has_begun(&self) -> bool {
        self.begun
    }

    /// The number that was to be the run's is that of the run before.
    pub(super) fn take_another_number(&mut self) {
        self.start.run = self.start.run.wrapping_add(1);
        self.assembly = RunAssembly::new(self.start.run);
    }

    /// Has the rig begin the run.
    pub(super) fn begin(&mut self) -> Result<(), TalkError> {
        self.client.request(Command::Start(self.start))?;
        self.begun = true;
        let now = self.client.now();
        (self.heard_at, self.frame_at, self.progress_at) = (now, now, now);
        (self.sign_of_life_at, self.status_at) = (now, now);
        Ok(())
    }

    /// Writes the run's frames until it is over and every frame is here or given up.
    pub(super) fn follow(
        &mut self,
        writer: &mut RecordingWriter,
        should_stop: &dyn Fn() -> Option<StopReason>,
        on_progress: &mut dyn FnMut(Progress<'_>),
    ) -> Result<(), CaptureError> {
        loop {
            if self.stop == Stop::NotWanted
                && let Some(reason) = should_stop()
            {
                self.stop = Stop::Wanted(reason);
            }
            self.listen()?;
            self.write_out(writer, on_progress)?;
            if self.everything_is_here() {
                return self.write_out_over_gaps(writer, on_progress);
            }
            self.forget_what_cannot_come();
            self.require_life()?;
            self.talk()?;
        }
    }

    /// Takes in what comes within a moment.
    fn listen(&mut self) -> Result<(), TalkError> {
        let mut message = self.client.receive(LISTEN)?;
        while let Some(current) = message {
            self.heard_at = self.client.now();
            self.take_in(&current)?;
            message = self.client.receive(Duration::ZERO)?;
        }
        Ok(())
    }

    fn take_in(&mut self, message: &RigMessage) -> Result<(), TalkError> {
        match message {
            RigMessage::Frame(frame) => {
                self.frame_at = self.heard_at;
                if self.assembly.take_in(*frame) {
                    self.progress_at = self.heard_at;
                }
            }
            RigMessage::Ended(ended) => self.note_end(ended),
            _ => {
                if let Some(asked) = self.asked
                    && let Some(answer) = asked.answer_in(message)
                {
                    self.asked = None;
                    return self.on_answer(asked.command(), &answer);
                }
            }
        }
        Ok(())
    }

    fn note_end(&mut self, ended: &Ended) {
        if ended.run == self.start.run && self.ended.is_none() {
            self.ended = Some(*ended);
            self.progress_at = self.client.now();
        }
    }

    fn on_answer(&mut self, command: &Command, answer: &Answer) -> Result<(), TalkError> {
        match (command, answer) {
            (_, Answer::Status(status)) => return self.on_status(status),
            (Command::Stop { .. }, Answer::Done) => {
                if let Stop::Wanted(reason) = &self.stop {
                    self.stop = Stop::Done(reason.clone());
                }
            }
            (Command::Resend { .. }, Answer::Done) => {
                if let Some(resend) = &mut self.resend {
                    resend.answers += 1;
                    resend.answered_at = Some(self.heard_at);
                }
            }
            // The session is another's, or the rig has been reset and has none.
            (_, Answer::Refused(Refusal::UnknownSession | Refusal::UnknownRun)) => {
                return Err(TalkError::RunForgotten);
            }
            _ => {}
        }
        self.denials = 0;
        Ok(())
    }

    fn on_status(&mut self, status: &Status) -> Result<(), TalkError> {
        self.status = Some(*status);
        match status.activity {
            Activity::Ended(ended) if ended.run == self.start.run => self.note_end(&ended),
            Activity::Running { run, .. } if run == self.start.run => {}
            _ => {
                self.denials += 1;
                return if self.denials >= DENIALS {
                    Err(TalkError::RunForgotten)
                } else {
                    Ok(())
                };
            }
        }
        self.denials = 0;
        Ok(())
    }

    /// Writes what is next in order.
    pub(super) fn write_out(
        &mut self,
        writer: &mut RecordingWriter,
        on_progress: &mut dyn FnMut(Progress<'_>),
    ) -> Result<(), CaptureError> {
        while let Some(frame) = self.assembly.let_out() {
            writer.append(&frame)?;
            self.written = u32::from(frame.index) + 1;
            on_progress(Progress {
                frame: &frame,
                frames_total: self.start.frames(),
                rejects: self.client.rejects(),
                asked_again: self.asked_again,
                lost: self.assembly.given_up(),
                status: self.status.as_ref(),
            });
        }
        Ok(())
    }

    /// Writes all that has come; what is missing before it is given up.
    pub(super) fn write_out_over_gaps(
        &mut self,
        writer: &mut RecordingWriter,
        on_progress: &mut dyn FnMut(Progress<'_>),
    ) -> Result<(), CaptureError> {
        loop {
            self.write_out(writer, on_progress)?;
            match self.assembly.first_gap(self.end_so_far()) {
                Some(gap) => self.assembly.give_up_before(gap.end),
                None => return Ok(()),
            }
        }
    }

    /// Whether the run is over and nothing of it can still be got.
    fn everything_is_here(&self) -> bool {
        self.ended.is_some_and(|ended| {
            self.assembly.position() >= u32::from(ended.frames)
                || self.assembly.lacks_only_what_the_board_lost(&ended)
        })
    }

    /// One past the last frame that there must have been.
    fn end_so_far(&self) -> u32 {
        self.ended
            .map_or(self.assembly.newest(), |ended| ended.frames.into())
    }

    fn require_life(&self) -> Result<(), TalkError> {
        let now = self.client.now();
        if now.saturating_sub(self.heard_at) > SILENT {
            return Err(TalkError::FellSilent {
                seconds: SILENT.as_secs(),
            });
        }
        if now.saturating_sub(self.progress_at) > STANDS_STILL {
            return Err(TalkError::NoFrames {
                seconds: STANDS_STILL.as_secs(),
            });
        }
        Ok(())
    }

    /// Says what is due, the most urgent first; a request that waits for its answer is said again.
    fn talk(&mut self) -> Result<(), TalkError> {
        let now = self.client.now();
        if matches!(self.stop, Stop::Wanted(_)) && self.ended.is_none() {
            let stopping =
                matches!(self.asked, Some(a) if matches!(a.command(), Command::Stop { .. }));
            if !stopping {
                return self.say(Command::Stop {
                    run: self.start.run,
                });
            }
        }
        if let Some(asked) = &mut self.asked {
            if !self.client.insist(asked)? {
                self.asked = None;
            }
            return Ok(());
        }
        let running = self.ended.is_none();
        let quiet_since = self.frame_at.max(self.status_at);
        if running && now.saturating_sub(quiet_since) > QUIET {
            self.status_at = now;
            return self.say(Command::Status);
        }
        if let Some(resend) = self.resend_due(now) {
            return self.say(resend);
        }
        if running && now.saturating_sub(self.sign_of_life_at) > SIGN_OF_LIFE_EVERY {
            return self.say(Command::Status);
        }
        Ok(())
    }

    /// Every request is a sign of life.
    fn say(&mut self, command: Command) -> Result<(), TalkError> {
        self.asked = Some(self.client.say(command)?);
        self.sign_of_life_at = self.client.now();
        Ok(())
    }

    /// Brings the servo to neutral after something went wrong on this side. Where the line is gone
    /// there is nobody to tell, and the lease does it.
    pub(super) fn stop_after(&mut self, error: &CaptureError) {
        if !matches!(error, CaptureError::Talk(TalkError::Broken(_))) {
            let run = self.start.run;
            let _nobody_there = self.client.request(Command::Stop { run });
        }
    }
}
