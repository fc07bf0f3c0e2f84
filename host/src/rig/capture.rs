//! Recording one run.
//!
//! Frames are written in order as they come. A gap is asked for again from the board's memory, at
//! once and again until it is filled or the board has forgotten it. The end is *complete* only when
//! the rig's own check over the run agrees with what was written.

use super::client::{RigClient, TalkError, session_number};
use super::file::RigFile;
use super::run::RunAssembly;
use crate::recording::{Ending, RecordingWriter, WriteError};
use servoid_protocol::hello::SCHEMA_HASH;
use servoid_protocol::message::{
    Activity, Arm, Command, EndReason, Ended, Frame, Refusal, RigMessage, Start,
};
use servoid_protocol::timing::{FRAME_US, FRAMES_PER_SECOND};
use servoid_protocol::{PulseWidth, Reference};
use std::ops::Range;
use std::time::Duration;

/// Rest before and after the reference: as long as the paper's longest hold, 0.8 s, so that what
/// settles within a hold has settled before the first edge.
pub const ROLL_FRAMES: u16 = (FRAMES_PER_SECOND * 8 / 10) as u16;

/// A run goes on for two seconds after the last sign of life from this program ...
const LEASE_FRAMES: u16 = (2 * FRAMES_PER_SECOND) as u16;
/// ... which gives one four times as often.
const KEEP_ALIVE_EVERY: Duration = Duration::from_millis(500);

/// Without a frame for this long, the rig is asked whether the run is over.
const QUIET: Duration = Duration::from_millis(200);

/// A gap is asked for again when the answer has had this long to come.
const RESEND_EVERY: Duration = Duration::from_millis(100);

/// Frames asked for at once: at 115200 baud and 36 bytes a frame they take a quarter of a second.
const RESEND_FRAMES: u32 = 64;

/// After the end, gaps are asked for this often without one frame coming, then given up.
const FRUITLESS_ROUNDS: u32 = 8;

/// What is to be recorded.
#[derive(Clone, Debug)]
pub struct Capture {
    /// What the user knows of their rig.
    pub rig: RigFile,
    /// The run.
    pub start: Start,
}

/// How a capture is getting on.
#[derive(Clone, Copy, Debug)]
pub struct Progress<'a> {
    /// The newest frame that was written.
    pub frame: &'a Frame,
    /// Frames that the run will have.
    pub frames_total: u32,
    /// Messages from the rig that could not be read.
    pub rejects: u32,
    /// Frames that had to be asked for again.
    pub asked_again: u32,
}

/// How a capture ended.
#[derive(Clone, Debug, PartialEq)]
pub struct CaptureEnd {
    /// Complete, or what is missing and why.
    pub ending: Ending,
    /// Rows written.
    pub rows: u64,
    /// Messages from the rig that could not be read.
    pub rejects: u32,
    /// Frames that had to be asked for again.
    pub asked_again: u32,
}

/// Why a capture did not take place or broke off. Rows written before are kept in every case.
#[derive(Debug, thiserror::Error)]
pub enum CaptureError {
    /// The rig.
    #[error(transparent)]
    Talk(#[from] TalkError),
    /// The file.
    #[error(transparent)]
    Write(#[from] WriteError),
}

impl Capture {
    /// A run of `reference` with the usual rest before and after it.
    #[must_use]
    pub fn new(rig: RigFile, reference: Reference) -> Self {
        let start = Start {
            run: session_number(),
            pre_roll_frames: ROLL_FRAMES,
            reference,
            post_roll_frames: ROLL_FRAMES,
        };
        Self { rig, start }
    }

    /// Brings the rig to neutral, so that the next thing it does can be the run.
    ///
    /// # Errors
    /// When the rig refuses or does not answer.
    pub fn arm(&self, client: &mut RigClient) -> Result<(), TalkError> {
        client.require_equal_schema()?;
        let [sensor_low, sensor_high] = self.rig.healthy_counts();
        client.request(Command::Arm(Arm {
            schema_hash: SCHEMA_HASH,
            neutral: PulseWidth(self.rig.servo.neutral_us),
            shortest: PulseWidth(self.rig.limits.shortest_us),
            longest: PulseWidth(self.rig.limits.longest_us),
            sensor_low,
            sensor_high,
            lease_frames: LEASE_FRAMES,
        }))
    }

    /// Records the run. `should_stop` is asked often; when it says yes, the servo goes to neutral
    /// and the recording is closed.
    ///
    /// # Errors
    /// [`CaptureError`]; the recording is closed as partial first where that is possible.
    pub fn record(
        &self,
        client: &mut RigClient,
        mut writer: RecordingWriter,
        should_stop: &dyn Fn() -> bool,
        on_progress: &mut dyn FnMut(Progress<'_>),
    ) -> Result<CaptureEnd, CaptureError> {
        let mut session = Session::new(client, self.start);
        let outcome = session.run(&mut writer, should_stop, on_progress);
        let (rejects, asked_again) = (session.rejects(), session.asked_again);
        if outcome.is_err() {
            // The rig may still be there (a full disk, say): do not leave it running until the
            // lease lapses. If it is not, there is nobody to tell.
            let _gone = session.client.request(Command::Stop {
                run: self.start.run,
            });
        }
        let rows = writer.rows();
        let ending = match &outcome {
            Ok(ended) => session.ending(ended),
            Err(error) => Ending::Partial {
                reason: error.to_string(),
                lost_frames: session.assembly.lost().to_vec(),
            },
        };
        match (outcome, writer.finish(&ending)) {
            (Ok(_), Ok(())) => Ok(CaptureEnd {
                ending,
                rows,
                rejects,
                asked_again,
            }),
            (Err(error), _) => Err(error),
            (Ok(_), Err(error)) => Err(error.into()),
        }
    }
}

/// A run under way.
struct Session<'a> {
    client: &'a mut RigClient,
    start: Start,
    assembly: RunAssembly,
    ended: Option<Ended>,
    stopping: bool,
    asked_again: u32,
    last_frame_at: Duration,
    last_sign_of_life: Duration,
    last_resend: Option<(Duration, Range<u32>)>,
}

impl<'a> Session<'a> {
    fn new(client: &'a mut RigClient, start: Start) -> Self {
        let now = client.now();
        Self {
            client,
            start,
            assembly: RunAssembly::new(start.run),
            ended: None,
            stopping: false,
            asked_again: 0,
            last_frame_at: now,
            last_sign_of_life: now,
            last_resend: None,
        }
    }

    fn rejects(&self) -> u32 {
        self.client.rejects().total()
    }

    fn run(
        &mut self,
        writer: &mut RecordingWriter,
        should_stop: &dyn Fn() -> bool,
        on_progress: &mut dyn FnMut(Progress<'_>),
    ) -> Result<Ended, CaptureError> {
        self.client.request(Command::Start(self.start))?;
        let mut fruitless = 0;
        loop {
            if should_stop() && !self.stopping {
                self.stopping = true;
                self.client.request(Command::Stop {
                    run: self.start.run,
                })?;
            }
            let before = self.assembly.position();
            self.listen()?;
            self.write_out(writer, on_progress)?;
            self.stay_alive()?;
            self.recover()?;
            if self.assembly.position() > before {
                fruitless = 0;
            }
            if let Some(ended) = self.ended {
                if self.assembly.position() >= u32::from(ended.frames) {
                    return Ok(ended);
                }
                if self.assembly.position() == before {
                    fruitless += 1;
                }
                if fruitless >= FRUITLESS_ROUNDS {
                    let gap_end = self.assembly.first_gap(ended.frames.into());
                    self.assembly
                        .give_up_before(gap_end.map_or(ended.frames.into(), |g| g.end));
                    fruitless = 0;
                }
            }
        }
    }

    /// Takes in what comes within a moment.
    fn listen(&mut self) -> Result<(), CaptureError> {
        let wait = if self.ended.is_some() {
            RESEND_EVERY
        } else {
            Duration::from_millis(20)
        };
        let mut message = self.client.receive(wait)?;
        while let Some(current) = message {
            match current {
                RigMessage::Frame(frame) => {
                    self.assembly.take_in(frame);
                    self.last_frame_at = self.client.now();
                }
                RigMessage::Ended(ended) if ended.run == self.start.run => self.ended = Some(ended),
                _ => {}
            }
            message = self.client.receive(Duration::ZERO)?;
        }
        Ok(())
    }

    fn write_out(
        &mut self,
        writer: &mut RecordingWriter,
        on_progress: &mut dyn FnMut(Progress<'_>),
    ) -> Result<(), CaptureError> {
        while let Some(frame) = self.assembly.let_out() {
            writer.append(&frame)?;
            on_progress(Progress {
                frame: &frame,
                frames_total: self.start.frames(),
                rejects: self.rejects(),
                asked_again: self.asked_again,
            });
        }
        Ok(())
    }

    /// Prolongs the lease; when nothing comes any more, finds out whether the run is over.
    fn stay_alive(&mut self) -> Result<(), CaptureError> {
        let now = self.client.now();
        if self.ended.is_some() {
            return Ok(());
        }
        if now.saturating_sub(self.last_frame_at) > QUIET {
            let status = self.client.status()?;
            match status.activity {
                Activity::Ended(ended) if ended.run == self.start.run => self.ended = Some(ended),
                Activity::Running { run, .. } if run == self.start.run => {}
                // A rig that knows nothing of the run has been reset, or taken over.
                _ => {
                    let refusal = Refusal::UnknownRun;
                    return Err(TalkError::Refused {
                        request: "go on with the run",
                        refusal,
                    }
                    .into());
                }
            }
            self.last_frame_at = now;
            self.last_sign_of_life = now;
        } else if now.saturating_sub(self.last_sign_of_life) > KEEP_ALIVE_EVERY {
            self.client.request(Command::KeepAlive)?;
            self.last_sign_of_life = now;
        }
        Ok(())
    }

    /// Asks for the first gap again, and gives up what the board has forgotten.
    fn recover(&mut self) -> Result<(), CaptureError> {
        let end = self
            .ended
            .map_or(self.assembly.newest(), |ended| ended.frames.into());
        let history = u32::from(self.client.hello().history_frames);
        self.assembly.give_up_before(end.saturating_sub(history));
        let Some(gap) = self.assembly.first_gap(end) else {
            return Ok(());
        };
        let gap = gap.start..gap.end.min(gap.start + RESEND_FRAMES);
        let now = self.client.now();
        if let Some((asked_at, asked)) = &self.last_resend
            && *asked == gap
            && now.saturating_sub(*asked_at) < RESEND_EVERY + line_time(&gap)
        {
            return Ok(());
        }
        let (first, count) = (gap.start as u16, gap.len() as u16);
        self.client.request(Command::Resend {
            run: self.start.run,
            first,
            count,
        })?;
        self.asked_again += u32::from(count);
        self.last_resend = Some((now, gap));
        Ok(())
    }

    fn ending(&self, ended: &Ended) -> Ending {
        if ended.reason == EndReason::Complete && self.assembly.is_whole(ended) {
            return Ending::Complete;
        }
        let reason = match ended.reason {
            EndReason::Complete if ended.frames_lost_on_board > 0 => {
                "the board could not keep up and lost frames"
            }
            EndReason::Complete if !self.assembly.lost().is_empty() => {
                "frames were lost on the line and the board had forgotten them when asked again"
            }
            EndReason::Complete => "the rig's check over the run differs from what arrived",
            EndReason::Stopped => "stopped by the user",
            EndReason::Disarmed => "the rig was disarmed",
            EndReason::LeaseLapsed => "the rig heard nothing from the host for two seconds",
            EndReason::SensorOutOfRange => {
                "the sensor read outside its healthy range: check its wiring"
            }
        };
        Ending::Partial {
            reason: reason.to_owned(),
            lost_frames: self.assembly.lost().to_vec(),
        }
    }
}

/// How long the line takes for that many frames beside the live ones.
fn line_time(frames: &Range<u32>) -> Duration {
    // 40 bytes at 11 520 bytes/s are 3.5 ms; a fifth of a frame's time is a little more.
    Duration::from_micros(u64::from(FRAME_US) / 5 * frames.len() as u64)
}
