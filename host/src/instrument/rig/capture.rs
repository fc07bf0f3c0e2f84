//! Recording one run.
//!
//! Frames are written in order as they come; the module `under_way` sees to it that they do. The end is
//! *complete* only when the rig's own check over the run agrees with what was written.

use super::client::{RigClient, TalkError, session_number};
use crate::data::recording::{Ending, RecordingWriter, WriteError};
use crate::data::rig_file::RigFile;
use crate::instrument::rig::run_follower::RunFollower;
use servoid_protocol::hello::SCHEMA_HASH;
use servoid_protocol::message::{Arm, Command, Frame, Refusal, Start, Status};
use servoid_protocol::timing::FRAMES_PER_SECOND;
use servoid_protocol::{PulseWidth, Reference, Rejects};
use std::time::Duration;

/// Rest before and after the reference: as long as the paper's longest hold, 0.8 s, so that what
/// settles within a hold has settled before the first edge.
pub const ROLL_FRAMES: u16 = (FRAMES_PER_SECOND * 8 / 10) as u16;

/// A run goes on for two seconds after the last sign of life from this program.
const LEASE_FRAMES: u16 = (2 * FRAMES_PER_SECOND) as u16;

/// Run numbers that are tried where the rig's last run had the same one.
const RUN_NUMBERS: u16 = 3;

/// How often arming is tried where the sensor reads outside its range, and the pause in between: five
/// frames.
const SENSOR_ATTEMPTS: u32 = 3;
const SENSOR_PAUSE: Duration = Duration::from_millis(100);

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
    /// Messages from the rig that could not be read, by class.
    pub rejects: Rejects,
    /// Frames that had to be asked for again.
    pub asked_again: u32,
    /// Frames that have been given up.
    pub lost: u32,
    /// What the rig last said of itself, about twice a second.
    pub status: Option<&'a Status>,
}

/// Why a run is to end before its reference does.
#[derive(Clone, Debug, PartialEq)]
pub enum StopReason {
    /// The user wants it: the recording is partial.
    User,
    /// What the run was made for has been reached, in plain words: the recording is whole as far as
    /// it goes.
    Enough(String),
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
    /// There is nothing to keep.
    #[error("stopped by the user before the run began: no file was written")]
    StoppedBefore,
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
        client.require_match()?;
        let healthy = self.rig.healthy_counts();
        let arm = Command::Arm(Arm {
            schema_hash: SCHEMA_HASH,
            neutral: PulseWidth(self.rig.servo.neutral_us),
            shortest: PulseWidth(self.rig.limits.shortest_us),
            longest: PulseWidth(self.rig.limits.longest_us),
            sensor_low: healthy.lowest,
            sensor_high: healthy.highest,
            lease_frames: LEASE_FRAMES,
        });
        // A board that was switched on a moment ago has not read its sensor yet, and one disturbed
        // sample is no broken sensor.
        for _ in 1..SENSOR_ATTEMPTS {
            match client.request(arm) {
                Err(TalkError::Refused {
                    refusal: Refusal::SensorOutOfRange,
                    ..
                }) => client.receive(SENSOR_PAUSE)?,
                other => return other,
            };
        }
        client.request(arm)
    }

    /// Records the run. `should_stop` is asked often; when it gives a reason, the servo goes to
    /// neutral and the recording is closed.
    ///
    /// # Errors
    /// [`CaptureError`]. The servo is at neutral then unless nobody answers, in which case the lease
    /// brings it there; every frame that came is in the recording, which is closed as partial, where
    /// the disk allows it.
    pub fn record(
        &self,
        client: &mut RigClient,
        mut writer: RecordingWriter,
        should_stop: &dyn Fn() -> Option<StopReason>,
        on_progress: &mut dyn FnMut(Progress<'_>),
    ) -> Result<CaptureEnd, CaptureError> {
        let mut run = RunFollower::new(client, self.start);
        let outcome = self.begin_and_follow(&mut run, &mut writer, should_stop, on_progress);
        if let Err(error) = &outcome {
            run.stop_after(error);
            if !matches!(error, CaptureError::Write(_)) {
                // What waited for an earlier frame is worth as much as the rest.
                let _the_first_error_is_told = run.write_out_over_gaps(&mut writer, on_progress);
            }
        }
        if !run.has_begun() && !writer.has_begun() {
            // No run, no recording: what was in the file is there still.
            return Err(outcome.err().unwrap_or(CaptureError::StoppedBefore));
        }
        let ending = match &outcome {
            Ok(()) => run.ending(),
            Err(error) => run.broken_off(error),
        };
        let (rows, rejects, asked_again) = (writer.rows(), run.rejects(), run.asked_again());
        match (outcome, writer.finish(&ending)) {
            (Ok(()), Ok(())) => Ok(CaptureEnd {
                ending,
                rows,
                rejects,
                asked_again,
            }),
            (Err(error), _) => Err(error),
            (Ok(()), Err(error)) => Err(error.into()),
        }
    }

    fn begin_and_follow(
        &self,
        run: &mut RunFollower<'_>,
        writer: &mut RecordingWriter,
        should_stop: &dyn Fn() -> Option<StopReason>,
        on_progress: &mut dyn FnMut(Progress<'_>),
    ) -> Result<(), CaptureError> {
        for _ in 0..RUN_NUMBERS {
            if should_stop().is_some() {
                return Ok(());
            }
            match run.begin() {
                Err(TalkError::Refused {
                    refusal: Refusal::RunRepeated,
                    ..
                }) => run.take_another_number(),
                Err(error) => return Err(error.into()),
                Ok(()) => return run.follow(writer, should_stop, on_progress),
            }
        }
        run.begin()?;
        run.follow(writer, should_stop, on_progress)
    }
}
