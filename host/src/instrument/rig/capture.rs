//! Recording one run.
//!
//! Frames are handed in order, as they come, to the thread that writes them. The end is *complete* only when the rig's own check over the
//! run agrees with the rows.

use super::capture_outcome::{CaptureEnd, CaptureError, Progress, StopReason};
use super::client::{RigClient, session_number};
use super::recording_ending::recording_ending;
use super::talk_error::TalkError;
use crate::data::recording::{Ending, QueuedWriter, RecordingWriter, WriteError};
use crate::data::rig_file::RigFile;
use crate::data::{DegreeScale, FrozenSensor, Movement};
use servoid_client::{Client, Event, RunEnding};
use servoid_protocol::lease::LEASE_S;
use servoid_protocol::message::{Arm, ArmFor, Start};
use servoid_protocol::schema::SCHEMA_HASH;
use servoid_protocol::timing::SAMPLES_PER_FRAME;
use servoid_protocol::{Counts, Frame, PulseTrain, PulseWidth, Reference};
use std::ops::Range;
use std::time::{Duration, Instant};

/// Rest before and after the reference.
const ROLL_US: u32 = 800_000;

/// Rest before and after the reference (frames of this train): as long as the paper's longest hold, 0.8 s or a little more, so
/// that what settles within a hold has settled before the first edge.
pub fn roll_frames(train: PulseTrain) -> u16 {
    // At most 54 frames of 15 ms.
    ROLL_US.div_ceil(train.frame_us()) as u16
}

/// How often a capture asks whether it is to stop, where no frame comes.
const STOP_ASKED_EVERY: Duration = Duration::from_millis(5);

/// How long a rig may take to stop a run that the user ends, with all that is to be fetched of it. The program ends
/// within a second of a signal, and the file takes some of that.
const STOPS_WITHIN: Duration = Duration::from_millis(600);

/// A run to be recorded.
#[derive(Clone, Debug)]
pub struct Capture {
    /// The rig.
    pub rig: RigFile,
    /// The run.
    pub start: Start,
}

impl Capture {
    /// A run of `reference` with the usual rest before and after it.
    pub fn new(rig: RigFile, reference: Reference) -> Self {
        let roll_frames = roll_frames(rig.train());
        let start = Start {
            run: session_number(),
            pre_roll_frames: roll_frames,
            reference,
            post_roll_frames: roll_frames,
        };
        Self { rig, start }
    }

    /// Brings the rig to neutral, so that the next thing it does can be the run.
    ///
    /// # Errors
    /// When the rig refuses or does not answer.
    pub fn arm(&self, client: &mut RigClient) -> Result<(), TalkError> {
        let [sensor_low, sensor_high] = self.rig.sensor.healthy_counts.map(Counts);
        let train = self.rig.train();
        let arm = Arm {
            schema_hash: SCHEMA_HASH,
            neutral: PulseWidth(self.rig.servo.neutral_us),
            shortest: PulseWidth(self.rig.limits.shortest_us),
            longest: PulseWidth(self.rig.limits.longest_us),
            sensor_low,
            sensor_high,
            lease_frames: train.frames_in(LEASE_S),
        };
        client.arm(ArmFor { train, arm })
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
        writer: RecordingWriter,
        should_stop: &dyn Fn() -> Option<StopReason>,
        on_progress: &mut dyn FnMut(Progress<'_>),
    ) -> Result<CaptureEnd, CaptureError> {
        let mut run = RecordedRun {
            writer: QueuedWriter::new(writer),
            on_progress,
            frames_total: self.start.frames(),
            written: 0,
            lost: Vec::new(),
            begun: false,
            sensor: FrozenSensor::new(self.rig.train().sample_s()),
            scale: DegreeScale::of_rig(&self.rig),
            movement: Movement::default(),
            stopped: None,
            stopped_at: None,
        };
        let outcome = run.follow(client, self.start, should_stop);
        if let Err(error) = &outcome {
            run.leave(client, error);
        }
        if !run.writer.has_begun() && (outcome.is_err() || !run.begun) {
            // No run, or no frame of it: no recording, and the file still has its earlier contents.
            return Err(outcome.err().unwrap_or(CaptureError::StoppedBefore));
        }
        let drained = run.writer.drain().map_err(CaptureError::from);
        // The failure of the disk comes first: it says how many rows there are.
        let outcome = drained.and(outcome);
        let lost_frames = run.missing();
        let ending = match &outcome {
            Ok(ended) => {
                let still = run.sensor.found().first();
                recording_ending(ended.as_ref(), run.stopped.as_ref(), still, lost_frames)
            }
            Err(error) => Ending::Partial {
                reason: error.to_string(),
                lost_frames,
            },
        };
        let rows = run.writer.rows();
        // Asked again: the end of the run may have come first.
        let user_waits = run.stopped.or_else(should_stop) == Some(StopReason::User);
        let closed = match user_waits {
            true => run.writer.finish_in_a_hurry(&ending),
            false => run.writer.finish(&ending),
        };
        outcome?;
        closed?;
        Ok(CaptureEnd {
            ending,
            rows,
            moved: run.movement.share(),
            apart_deg: run.movement.apart_deg(),
            rejects: client.rejects().total(),
            asked_again: client.conversation().frames_asked_again(),
        })
    }
}

/// A run that is being recorded.
struct RecordedRun<'a> {
    writer: QueuedWriter,
    on_progress: &'a mut dyn FnMut(Progress<'_>),
    frames_total: u32,
    /// One past the newest frame that was handed to the file.
    written: u32,
    /// Frames that are missing before it.
    lost: Vec<Range<u32>>,
    /// Whether the rig has reported that it has begun.
    begun: bool,
    sensor: FrozenSensor,
    scale: DegreeScale,
    movement: Movement,
    stopped: Option<StopReason>,
    stopped_at: Option<Instant>,
}

impl RecordedRun<'_> {
    /// Writes the run's frames until it is over; `None` where it was stopped before it began.
    fn follow(
        &mut self,
        client: &mut RigClient,
        start: Start,
        should_stop: &dyn Fn() -> Option<StopReason>,
    ) -> Result<Option<RunEnding>, CaptureError> {
        self.stopped = should_stop();
        if self.stopped.is_some() {
            return Ok(None);
        }
        client.begin_run(start);
        loop {
            match client.next_event(STOP_ASKED_EVERY)? {
                Some(Event::RunBegun { .. }) => self.begun = true,
                Some(Event::Frame(frame)) => self.write(&frame, client.conversation())?,
                Some(Event::RunEnded(ending)) => return Ok(Some(ending)),
                Some(Event::Failed(error)) => return Err(TalkError::from(error).into()),
                Some(_) | None => {}
            }
            self.writer.check()?;
            if self.stopped.is_none() {
                self.stopped = should_stop();
                if self.stopped.is_some() {
                    self.stopped_at = Some(Instant::now());
                    client.stop_run();
                }
            } else if self.should_let_go() {
                return Err(CaptureError::NotStopped);
            }
        }
    }

    /// Whether the user has waited long enough for the rig to stop.
    fn should_let_go(&self) -> bool {
        let waited = self
            .stopped_at
            .is_some_and(|at| at.elapsed() > STOPS_WITHIN);
        waited && self.stopped == Some(StopReason::User)
    }

    /// Lets go of the run after an error, and writes the rest of what came where the file takes it.
    fn leave(&mut self, client: &mut RigClient, error: &CaptureError) {
        let line_is_gone = matches!(
            error,
            CaptureError::Talk(TalkError::Broken(_)) | CaptureError::NotStopped
        );
        let mut file_takes_it = !matches!(error, CaptureError::Write(_));
        client.leave_run(line_is_gone, |event, client| {
            if let Event::Frame(frame) = event {
                file_takes_it = file_takes_it && self.write(&frame, client).is_ok();
            }
        });
    }

    /// Writes the next frame; those between it and the one before are lost.
    fn write(&mut self, frame: &Frame, client: &Client) -> Result<(), WriteError> {
        let index = u32::from(frame.index);
        if self.written < index {
            self.lost.push(self.written..index);
        }
        self.writer.append(frame)?;
        self.written = index + 1;
        let first = u64::from(index) * SAMPLES_PER_FRAME as u64;
        for (sample, &counts) in (first..).zip(&frame.samples) {
            self.sensor.take(sample, frame.pulse, counts);
        }
        let positions = frame.samples.map(|counts| self.scale.angle(counts));
        let command = self.scale.reference(frame.pulse);
        self.movement.take(command, positions);
        (self.on_progress)(Progress {
            frame,
            frames_total: self.frames_total,
            rejects: client.rejects(),
            asked_again: client.frames_asked_again(),
            lost: self.lost.iter().map(|gap| gap.end - gap.start).sum(),
            status: client.status(),
            stands_still: self.sensor.now(),
        });
        Ok(())
    }

    /// Every frame that is missing, with those that the run would still have had.
    fn missing(&self) -> Vec<Range<u32>> {
        let end = self.writer.end();
        // Frames behind it came, and could not be written.
        let mut missing: Vec<_> = self
            .lost
            .iter()
            .filter(|gap| gap.start < end)
            .cloned()
            .collect();
        if end < self.frames_total {
            missing.push(end..self.frames_total);
        }
        missing
    }
}
