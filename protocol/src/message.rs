//! Requests and what the rig answers.
//!
//! Rules of evolution:
//!
//! 1. Enums grow at the end only; a variant is never reordered, removed or given another meaning.
//! 2. A struct inside a message is never changed; what must be said beside it is a new variant.
//! 3. Any change alters [`SCHEMA_HASH`](crate::schema::SCHEMA_HASH), and unequal hashes do not arm.
//! 4. The first variant of [`Command`] and of [`RigMessage`] is unused: the byte that says what a
//!    message is is never zero, the value that a dead line or blank memory would give.
//!
//! # Requests may be repeated
//!
//! A host that hears nothing says the same again. A [`Request`] carries the host's `session` and an
//! `id` that rises by one with each new request (wrapping); the rig answers a repeated id with the
//! outcome that it gave before and does nothing else, and refuses an id older than the newest one,
//! so that a copy that comes late can have no effect. [`Command::Hello`] opens a session; one whose
//! own session is open already with a newer id is a late copy like any other, so a host that
//! connects chooses a session by chance and another one where that is refused.

use crate::framing::CRC;
use crate::hello::Hello;
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
    /// What is asked for.
    pub command: Command,
}

/// What a host may ask for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum Command {
    /// Never sent: see rule 4.
    Unused,
    /// Opens a session, unless another one has armed the rig and its lease is not over; answered with
    /// [`RigMessage::Hello`] in any case.
    Hello,
    /// Answered with [`RigMessage::Status`].
    Status,
    /// Start pulses, at neutral.
    Arm(Arm),
    /// Stop pulses. Ends a run first.
    Disarm,
    /// Begin a run; the rig must be armed and not running. The frames of the run before are
    /// forgotten.
    Start(Start),
    /// End the run of that number and go to neutral at the next frame edge. The frame under way is
    /// not part of the run any more.
    Stop {
        /// The run's number.
        run: u16,
    },
    /// The host is alive: begins a new lease.
    KeepAlive,
    /// Send these frames again. Frames that are no longer in memory are passed over.
    Resend {
        /// The run's number.
        run: u16,
        /// The first frame's index.
        first: u16,
        /// How many frames.
        count: u16,
    },
}

/// What a rig needs to know before it makes a pulse.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Arm {
    /// The host's [`SCHEMA_HASH`](crate::schema::SCHEMA_HASH).
    pub schema_hash: u64,
    /// The pulse to rest at.
    pub neutral: PulseWidth,
    /// The shortest pulse that this servo may be given.
    pub shortest: PulseWidth,
    /// The longest pulse that this servo may be given.
    pub longest: PulseWidth,
    /// The smallest reading of a healthy sensor.
    pub sensor_low: Counts,
    /// The largest reading of a healthy sensor.
    pub sensor_high: Counts,
    /// Frames that a run goes on after the last sign of life from the host; at least one.
    pub lease_frames: u16,
}

/// One run: rest at neutral, the reference, rest at neutral.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Start {
    /// Chosen by the host; differs from the run before.
    pub run: u16,
    /// Frames at neutral before the reference.
    pub pre_roll_frames: u16,
    /// What the servo is told.
    pub reference: Reference,
    /// Frames at neutral after the reference.
    pub post_roll_frames: u16,
}

impl Start {
    /// Length of the whole run (frames).
    #[must_use]
    pub fn frames(&self) -> u32 {
        u32::from(self.pre_roll_frames)
            .saturating_add(self.reference.frames())
            .saturating_add(u32::from(self.post_roll_frames))
    }

    /// Offset from neutral in frame `index` of the run (µs), or `None` past its end.
    #[must_use]
    pub fn offset_us(&self, index: u32) -> Option<i16> {
        if index >= self.frames() {
            return None;
        }
        let in_reference = index.checked_sub(u32::from(self.pre_roll_frames));
        Some(
            in_reference
                .and_then(|f| self.reference.offset_us(f))
                .unwrap_or(0),
        )
    }
}

/// Rig to host.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum RigMessage {
    /// Never sent: see rule 4.
    Unused,
    /// Answer to [`Command::Hello`].
    Hello(Hello),
    /// Answer to every request but `Hello` and `Status`.
    Reply {
        /// The request's session.
        session: u16,
        /// The request's id.
        id: u16,
        /// What came of it.
        outcome: Outcome,
    },
    /// Answer to [`Command::Status`].
    Status(Status),
    /// One PWM frame of a run, live or sent again.
    Frame(Frame),
    /// A run has ended. Said once on its own; [`Status`] repeats it.
    Ended(Ended),
}

/// What came of a request.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum Outcome {
    /// Done, or already so.
    Done,
    /// Not done, and why.
    Refused(Refusal),
}

/// Why a request was refused. Nothing has changed when one is.
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
    /// A run is under way.
    Running,
    /// The limits or the neutral pulse leave what the board allows, or contradict each other.
    BadLimits,
    /// The reference leaves the limits.
    BeyondLimits,
    /// The reference is empty, too long or contradicts itself.
    BadReference,
    /// That run is neither under way nor the last one.
    UnknownRun,
    /// The sensor reads outside its healthy range.
    SensorOutOfRange,
    /// The run's number is that of the run before: its frames could be taken for the old ones.
    RunRepeated,
}

/// One PWM frame of a run: the pulse that was *applied*, and the samples taken during it.
///
/// At most 40 bytes on the wire while the counts take two bytes each.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Frame {
    /// The run's number.
    pub run: u16,
    /// Frames since the run's first one.
    pub index: u16,
    /// The pulse that was on the line in this frame; never zero.
    pub pulse: PulseWidth,
    /// The samples, in order.
    pub samples: [Counts; SAMPLES_PER_FRAME],
}

/// How a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum EndReason {
    /// The reference and the post-roll are through.
    Complete,
    /// The host asked for it.
    Stopped,
    /// The host asked for the pulses to stop.
    Disarmed,
    /// No sign of life from the host for a whole lease.
    LeaseLapsed,
    /// The sensor read outside its healthy range five times in a row.
    SensorOutOfRange,
}

/// A run that has ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Ended {
    /// The run's number.
    pub run: u16,
    /// Why.
    pub reason: EndReason,
    /// Frames that the run had: indices `0..frames`.
    pub frames: u16,
    /// Frames that the board itself failed to catch; their indices will never come.
    pub frames_lost_on_board: u16,
    /// [`RunCheck`] over every frame that the board caught, in order.
    pub check: u32,
}

/// What the rig is doing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum Activity {
    /// No pulses.
    Idle,
    /// Pulses at neutral; no run yet.
    Armed,
    /// A run is under way.
    Running {
        /// The run's number.
        run: u16,
        /// Frames so far.
        frames: u16,
    },
    /// Pulses at neutral; the last run is over.
    Ended(Ended),
}

/// How the rig and its link are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Status {
    /// What the rig is doing.
    pub activity: Activity,
    /// The newest sensor reading.
    pub sensor: Counts,
    /// PWM frames since the rig started.
    pub frames_since_start: u32,
    /// PWM frames that the board failed to catch since it started.
    pub frames_lost_on_board: u32,
    /// Requests that the rig could not read since it started, all classes together.
    pub rejects: u32,
    /// The most frames that ever waited to be sent.
    pub backlog_high_water: u16,
}

/// CRC-32 over the frames of a run, kept by the rig and again by the host: equal values prove that
/// the recording is the run.
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
    #[must_use]
    pub fn new() -> Self {
        Self(CRC.digest())
    }

    /// Takes in the next frame. The run's number is left out: it names the run, it is not in it.
    pub fn update(&mut self, frame: &Frame) {
        self.0.update(&frame.index.to_le_bytes());
        self.0.update(&frame.pulse.0.to_le_bytes());
        for sample in &frame.samples {
            self.0.update(&sample.0.to_le_bytes());
        }
    }

    /// The check of the frames so far.
    #[must_use]
    pub fn value(&self) -> u32 {
        self.0.clone().finalize()
    }
}

impl core::fmt::Debug for RunCheck {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(f, "RunCheck({:#010x})", self.value())
    }
}
