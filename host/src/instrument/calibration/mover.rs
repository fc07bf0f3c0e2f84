//! Brings the servo to positions, and reads the sensor once it rests there.

use crate::data::recording::{Ending, Header, RecordingWriter};
use crate::data::rig_file::RigFile;
use crate::instrument::rig::{Capture, CaptureError, RigClient, StopReason, TalkError};
use serde::Serialize;
use servoid_protocol::reference::{MAX_STEPS, Reference, Step, Steps};
use servoid_protocol::{Frame, PulseTrain, PulseWidth};
use std::cell::RefCell;
use std::io::sink;
use std::path::Path;

/// Rest before a position is read: half a second or a little more, four times what the paper's servo takes to settle. For as
/// long it is read then.
fn settle_frames(train: PulseTrain) -> u16 {
    train.frames_in(1).div_ceil(2)
}

/// Frames that a position takes.
fn hold_frames(train: PulseTrain) -> u16 {
    2 * settle_frames(train)
}

/// A position that is held until somebody has read a protractor is left after so long (s): 16 minutes, with the shortest
/// frames as many as 16 bits number.
const LONGEST_HOLD_S: u32 = 16 * 60;

/// The sensor while the servo rests.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Rest {
    /// The pulse that holds it there (µs).
    pub pulse_us: u16,
    /// Mean of the samples (counts).
    pub counts: f64,
    /// Their standard deviation (counts).
    pub sd_counts: f64,
    /// How many.
    pub samples: usize,
}

impl Rest {
    /// Of the samples of `frames`, of which there has to be one.
    fn of(pulse_us: u16, frames: &[Frame]) -> Self {
        let all = || frames.iter().flat_map(|frame| frame.samples);
        let samples = all().count();
        let counts = all().map(|c| f64::from(c.0)).sum::<f64>() / samples as f64;
        let square = all()
            .map(|c| (f64::from(c.0) - counts).powi(2))
            .sum::<f64>();
        Self {
            pulse_us,
            counts,
            sd_counts: (square / (samples as f64 - 1.0)).sqrt(),
            samples,
        }
    }
}

/// Why there is no reading.
#[derive(Debug, thiserror::Error)]
pub enum MoveError {
    /// The rig.
    #[error(transparent)]
    Talk(#[from] TalkError),
    /// The rig, while it ran.
    #[error(transparent)]
    Capture(#[from] CaptureError),
    /// The run is not whole.
    #[error("the servo is back at neutral, and the calibration has no result: {0}")]
    BrokenOff(String),
    /// Beyond the limits of the rig file.
    #[error("{pulse_us} µs is beyond the limits of the rig file, {shortest} to {longest} µs")]
    BeyondLimits {
        /// The pulse that was asked for.
        pulse_us: u16,
        /// The shortest one that is allowed.
        shortest: u16,
        /// The longest one.
        longest: u16,
    },
}

/// Moves a servo within the limits of its rig file. After each movement it is back at neutral.
pub struct Mover<'a> {
    client: RigClient,
    rig: RigFile,
    /// Whether the user wants to stop.
    interrupted: &'a dyn Fn() -> bool,
}

impl<'a> Mover<'a> {
    /// A mover of the servo at the other end of `client`, which stops when `interrupted`.
    pub fn new(client: RigClient, rig: RigFile, interrupted: &'a dyn Fn() -> bool) -> Self {
        Self {
            client,
            rig,
            interrupted,
        }
    }

    /// Whether the rig's time stands still while nobody listens to it, as that of a simulated one.
    pub fn is_paced_by_reader(&self) -> bool {
        self.client.is_paced_by_reader()
    }

    /// The rig that is moved.
    pub fn rig(&self) -> &RigFile {
        &self.rig
    }

    /// Goes from one pulse to the next and reads the sensor at each, until the readings so far are
    /// `enough`.
    ///
    /// # Errors
    /// [`MoveError`]; the servo is at neutral, or the lease brings it there.
    pub fn visit(
        &mut self,
        pulses_us: &[u16],
        enough: &dyn Fn(&[Rest]) -> bool,
    ) -> Result<Vec<Rest>, MoveError> {
        let train = self.rig.train();
        let mut rests: Vec<Rest> = Vec::new();
        for part in pulses_us.chunks(MAX_STEPS) {
            let steps = self.steps(part, hold_frames(train))?;
            let frames = self.run(&steps, &|frames| {
                let so_far = [rests.as_slice(), &readings(part, train, frames)].concat();
                enough(&so_far).then(|| StopReason::Enough("all has been seen".into()))
            })?;
            rests.extend(readings(part, train, &frames));
            if enough(&rests) {
                break;
            }
        }
        Ok(rests)
    }

    /// Holds a position until the reading there is `done`, which is asked again and again.
    ///
    /// # Errors
    /// [`MoveError`], also when it is not for 16 minutes.
    pub fn hold(&mut self, pulse_us: u16, done: &dyn Fn(&Rest) -> bool) -> Result<Rest, MoveError> {
        let train = self.rig.train();
        let steps = self.steps(&[pulse_us], train.frames_in(LONGEST_HOLD_S))?;
        let found = RefCell::new(None);
        self.run(&steps, &|frames| {
            let mut found = found.borrow_mut();
            let rest = match *found {
                Some(rest) => rest,
                None => *readings(&[pulse_us], train, frames).first()?,
            };
            *found = Some(rest);
            done(&rest).then(|| StopReason::Enough("the position has been read".into()))
        })?;
        let rest = found.into_inner().filter(done);
        rest.ok_or_else(|| MoveError::BrokenOff("nobody has read the angle for 16 minutes".into()))
    }

    /// One step for each pulse, which have to lie within the limits.
    fn steps(&self, pulses_us: &[u16], hold_frames: u16) -> Result<Vec<Step>, MoveError> {
        let limits = &self.rig.limits;
        let step = |&pulse_us: &u16| {
            if !(limits.shortest_us..=limits.longest_us).contains(&pulse_us) {
                return Err(MoveError::BeyondLimits {
                    pulse_us,
                    shortest: limits.shortest_us,
                    longest: limits.longest_us,
                });
            }
            let offset = i32::from(pulse_us) - i32::from(self.rig.servo.neutral_us);
            Ok(Step {
                offset_us: i16::try_from(offset).unwrap_or(0),
                hold_frames,
            })
        };
        let mut steps = pulses_us.iter().map(step).collect::<Result<Vec<_>, _>>()?;
        // A reference has to move: a microsecond at the end of a hold at neutral that nobody waits for.
        if steps.iter().all(|step| step.offset_us == 0) {
            let upwards = limits.longest_us > self.rig.servo.neutral_us;
            steps.push(Step {
                offset_us: if upwards { 1 } else { -1 },
                hold_frames: 1,
            });
        }
        Ok(steps)
    }

    /// Runs a table of steps; `stop` is asked often, of the frames of the steps so far.
    fn run(
        &mut self,
        steps: &[Step],
        stop: &dyn Fn(&[Frame]) -> Option<StopReason>,
    ) -> Result<Vec<Frame>, MoveError> {
        let too_many = || MoveError::BrokenOff(format!("{} positions are too many", steps.len()));
        let table = Steps::new(1, steps).ok_or_else(too_many)?;
        let mut capture = Capture::new(self.rig.clone(), Reference::Steps(table));
        let settle_frames = settle_frames(self.rig.train());
        capture.start.pre_roll_frames = settle_frames;
        capture.start.post_roll_frames = 0;
        capture.arm(&mut self.client)?;
        // Frames are kept in memory, and their recording is not wanted.
        let header = Header::of_run(self.client.hello(), &self.rig, &capture.start);
        let writer = RecordingWriter::on(Box::new(sink()), Path::new("the calibration"), &header);
        let frames = RefCell::new(Vec::new());
        let should_stop = || {
            if (self.interrupted)() {
                return Some(StopReason::User);
            }
            stop(&frames.borrow())
        };
        let keep = |frame: &Frame| {
            if frame.index >= settle_frames {
                frames.borrow_mut().push(*frame);
            }
        };
        let end = capture.record(
            &mut self.client,
            writer.map_err(CaptureError::Write)?,
            &should_stop,
            &mut |progress| keep(progress.frame),
        )?;
        match end.ending {
            Ending::Partial { reason, .. } => Err(MoveError::BrokenOff(reason)),
            Ending::Complete | Ending::Early { .. } => Ok(frames.into_inner()),
        }
    }
}

/// What there is of the readings at each pulse, for as many as are whole.
fn readings(pulses_us: &[u16], train: PulseTrain, frames: &[Frame]) -> Vec<Rest> {
    let holds = frames.chunks_exact(hold_frames(train).into());
    let reading = |(&pulse_us, hold): (&u16, &[Frame])| {
        let rest = hold.get(usize::from(settle_frames(train))..)?;
        let held = rest.iter().all(|frame| frame.pulse == PulseWidth(pulse_us));
        held.then(|| Rest::of(pulse_us, rest))
    };
    pulses_us.iter().zip(holds).map_while(reading).collect()
}
