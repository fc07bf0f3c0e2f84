//! Requests of the host, and messages of the rig.
//!
//! Rules of evolution:
//!
//! 1. Enums grow at the end only; a variant is never reordered, removed or given another meaning.
//! 2. A struct inside a message is never changed; an addition is a new variant.
//! 3. Any change alters [`SCHEMA_HASH`](crate::schema::SCHEMA_HASH), and unequal hashes do not arm.
//! 4. The first variant of [`Command`] and of [`RigMessage`] is unused. So the byte that names the
//!    kind of a message is never zero, as it would be from a dead line or blank memory.
//!
//! # Requests may be repeated
//!
//! A host without an answer repeats its request. A [`Request`] carries the host's `session` and an
//! `id` that rises by one with each new request (wrapping). The rig answers a repeated id with the
//! same outcome as before, and does nothing else. It refuses an id older than the newest one, so a
//! late copy has no effect. [`Command::Hello`] opens a session, unless that session is already open
//! with a newer id: then it is a late copy too. So a host that connects chooses a session at random,
//! and another one if that is refused.

use crate::framing::CRC;
use crate::health::Health;
use crate::hello::Hello;
use crate::loopback::{Loopback, LoopbackFrame, Vitals};
use crate::pulse_train::PulseTrain;
use crate::reference::Reference;
use crate::timing::SAMPLES_PER_FRAME;
use crate::units::{Counts, PulseWidth};
use crc::{Digest, Table};
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// Host to rig.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Request {
    /// Chosen by the host when it connects.
    pub session: u16,
    /// Rises by one with each new request of the session, wrapping.
    pub id: u16,
    /// The command.
    pub command: Command,
}

/// The commands of a host.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum Command {
    /// Never sent: see rule 4.
    Unused,
    /// Opens a session, unless another one has armed the rig and its lease is not over; answered with
    /// [`RigMessage::Hello`] in any case.
    Hello,
    /// Answered with [`RigMessage::Status`].
    Status,
    /// Start pulses, at neutral, of the usual train: wide ones at 50 Hz.
    Arm(Arm),
    /// Stop pulses. Ends a run first.
    Disarm,
    /// Begin a run; the rig must be armed and not running. Drops the frames of the run before.
    Start(Start),
    /// End the run of that number and go to neutral at the next frame edge. The present frame is
    /// not part of the run any more.
    Stop {
        /// The run's number.
        run: u16,
    },
    /// The host is alive: begins a new lease.
    KeepAlive,
    /// Send these frames again. Frames that are no longer in memory are skipped.
    Resend {
        /// The run's number.
        run: u16,
        /// The first frame's index.
        first: u16,
        /// How many frames.
        count: u16,
    },
    /// Answered with [`RigMessage::Health`].
    Health,
    /// Answered with [`RigMessage::Vitals`].
    Vitals,
    /// The self-test: make these pulses, as long as the board sees them at its sensor's pin. Answered with
    /// [`RigMessage::Loopback`], unless it is refused.
    Loopback(Loopback),
    /// [`Command::Arm`], for a servo that takes other pulses than the usual ones.
    ArmFor(ArmFor),
}

/// The limits of a servo and its sensor, and the lease: all that a rig needs before it makes a pulse.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Arm {
    /// The host's [`SCHEMA_HASH`](crate::schema::SCHEMA_HASH).
    pub schema_hash: u64,
    /// The pulse at rest.
    pub neutral: PulseWidth,
    /// The shortest pulse for this servo.
    pub shortest: PulseWidth,
    /// The longest pulse for this servo.
    pub longest: PulseWidth,
    /// The smallest reading of a healthy sensor.
    pub sensor_low: Counts,
    /// The largest reading of a healthy sensor.
    pub sensor_high: Counts,
    /// Frames for which a run goes on after the last request of the host; at least one.
    pub lease_frames: u16,
}

/// Arming for a servo with this train of pulses.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct ArmFor {
    /// The pulses that the servo takes. The board holds their type until its next start.
    pub train: PulseTrain,
    /// The limits; the lease is in frames of that train.
    pub arm: Arm,
}

impl From<ArmFor> for Command {
    /// The shorter request where it is enough.
    fn from(asked: ArmFor) -> Self {
        match asked.train {
            PulseTrain::USUAL => Self::Arm(asked.arm),
            _ => Self::ArmFor(asked),
        }
    }
}

/// One run: rest at neutral, the reference, rest at neutral.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Start {
    /// Chosen by the host; differs from the run before.
    pub run: u16,
    /// Frames at neutral before the reference.
    pub pre_roll_frames: u16,
    /// The reference.
    pub reference: Reference,
    /// Frames at neutral after the reference.
    pub post_roll_frames: u16,
}

impl Start {
    /// Length of the whole run (frames).
    pub fn frames(&self) -> u32 {
        u32::from(self.pre_roll_frames)
            .saturating_add(self.reference.frames())
            .saturating_add(u32::from(self.post_roll_frames))
    }

    /// Offset from neutral in frame `index` of the run (µs), or `None` past its end.
    pub fn offset_us(&self, index: u32) -> Option<i16> {
        if index >= self.frames() {
            return None;
        }
        let in_reference = index.checked_sub(u32::from(self.pre_roll_frames));
        let offset_us = in_reference.and_then(|frame| self.reference.offset_us(frame));
        Some(offset_us.unwrap_or(0))
    }
}

/// Rig to host.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum RigMessage {
    /// Never sent: see rule 4.
    Unused,
    /// Answer to [`Command::Hello`].
    Hello(Hello),
    /// Answer to every request but `Hello`, `Status`, `Health`, `Vitals`, and a `Loopback` that is not refused.
    Reply {
        /// The request's session.
        session: u16,
        /// The request's id.
        id: u16,
        /// Its outcome.
        outcome: Outcome,
    },
    /// Answer to [`Command::Status`].
    Status(Status),
    /// One frame of a run, live or sent again.
    Frame(Frame),
    /// A run has ended. Sent once; [`Status`] repeats it.
    Ended(Ended),
    /// Answer to [`Command::Health`].
    Health(Health),
    /// Answer to [`Command::Vitals`].
    Vitals(Vitals),
    /// Answer to [`Command::Loopback`].
    Loopback(LoopbackFrame),
}

/// The outcome of a request.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum Outcome {
    /// Done, or already so.
    Done,
    /// Not done, for this reason.
    Refused(Refusal),
}

/// The reason why a request was refused. A refused request changes nothing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum Refusal {
    /// The session was never opened, or another host has opened one since.
    UnknownSession,
    /// The id is older than the session's newest one.
    Outdated,
    /// The host was built for other messages than the rig.
    SchemaDiffers,
    /// The rig is not armed.
    NotArmed,
    /// The rig is running.
    Running,
    /// The limits or the neutral pulse exceed those of the board, or contradict each other.
    BadLimits,
    /// The reference leaves the limits.
    BeyondLimits,
    /// The reference is empty, too long or contradicts itself.
    BadReference,
    /// That run is neither the present one nor the last one.
    UnknownRun,
    /// The sensor reads outside its healthy range.
    SensorOutOfRange,
    /// The run's number is that of the run before: their frames could be confused.
    RunRepeated,
    /// The board's own supply is too low for exact readings.
    SupplyLow,
    /// Too long after the last sign of life of the host: it may be a request of one that is gone.
    LeaseLapsed,
    /// No board makes such a train of pulses: its rate is not one of its type.
    NoSuchTrain,
    /// The board was armed for the other type of pulses since its last start.
    OtherPulseType,
}

/// One frame of a run: the *applied* pulse, and the samples taken during it.
///
/// At most 40 bytes on the wire while the counts take two bytes each.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Frame {
    /// The run's number.
    pub run: u16,
    /// Frames since the run's first one.
    pub index: u16,
    /// The width of the pulses on the line in this frame; never zero.
    pub pulse: PulseWidth,
    /// The samples, in order.
    pub samples: [Counts; SAMPLES_PER_FRAME],
}

/// The reason for the end of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum EndReason {
    /// The reference and the post-roll are complete.
    Complete,
    /// The host stopped the run.
    Stopped,
    /// The host stopped the pulses.
    Disarmed,
    /// No request of the host for a whole lease.
    LeaseLapsed,
    /// The sensor read outside its healthy range five times in a row.
    SensorOutOfRange,
    /// The board's own supply was too low for exact readings.
    SupplyLow,
}

/// A run that has ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Ended {
    /// The run's number.
    pub run: u16,
    /// The reason.
    pub reason: EndReason,
    /// Frames of the run: indices `0..frames`.
    pub frames: u16,
    /// Frames that the board itself lost; their indices never come.
    pub frames_lost_on_board: u16,
    /// [`RunCheck`] over all captured frames, in order.
    pub check: u32,
}

/// The present activity of the rig.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum Activity {
    /// No pulses.
    Idle,
    /// Pulses at neutral; no run yet.
    Armed,
    /// A run.
    Running {
        /// The run's number.
        run: u16,
        /// Frames so far.
        frames: u16,
    },
    /// Pulses at neutral; the last run is over.
    Ended(Ended),
    /// The self-test.
    Loopback,
}

/// The state of the rig and its link.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Status {
    /// The present activity.
    pub activity: Activity,
    /// The newest sensor reading.
    pub sensor: Counts,
    /// PWM frames since the rig started.
    pub frames_since_start: u32,
    /// PWM frames that the board has lost since it started.
    pub frames_lost_on_board: u32,
    /// Rejected frames since the rig started.
    pub rejects: u32,
    /// Largest number of frames that have waited to be sent.
    pub backlog_high_water: u16,
}

/// CRC-32 over the frames of a run. Rig and host each compute it; equal values prove that the
/// recording is the run.
///
/// ```
/// use servoid_protocol::{Counts, Frame, PulseWidth, RunCheck};
/// let frame = Frame { run: 1, index: 0, pulse: PulseWidth(1500), samples: [Counts(7); 10] };
/// let (mut rig, mut host) = (RunCheck::new(), RunCheck::new());
/// rig.update(&frame);
/// assert_ne!(rig.value(), host.value());
/// host.update(&frame);
/// assert_eq!(rig.value(), host.value());
/// ```
#[derive(Clone)]
pub struct RunCheck(Digest<'static, u32, Table<1>>);

impl Default for RunCheck {
    fn default() -> Self {
        Self::new()
    }
}

impl RunCheck {
    /// The check of no frame.
    pub fn new() -> Self {
        Self(CRC.digest())
    }

    /// Adds the next frame, without the run's number: that names the run, it is not in it.
    pub fn update(&mut self, frame: &Frame) {
        self.0.update(&frame.index.to_le_bytes());
        self.0.update(&frame.pulse.0.to_le_bytes());
        for sample in &frame.samples {
            self.0.update(&sample.0.to_le_bytes());
        }
    }

    /// The check of the frames so far.
    pub fn value(&self) -> u32 {
        self.0.clone().finalize()
    }
}

impl core::fmt::Debug for RunCheck {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(f, "RunCheck({:#010x})", self.value())
    }
}
