//! The rig as a state machine without I/O.
//!
//! A [`Rig`] takes frames and requests, and gives the next pulse and the messages to send. It has no clock: time is
//! the number of the frame. Pulses change at frame edges only, so a request takes effect at the frame edge after the
//! next captured frame.
//!
//! # States and transitions
//!
//! | state     | pulse     | `Arm`      | `Start`     | `Stop` | `Disarm` | the run's last frame, lease lapsed, sensor failed, supply low |
//! |-----------|-----------|------------|-------------|--------|----------|--------------------|
//! | Idle      | none      | -> Armed   | `NotArmed`  | (1)    | stays    |                    |
//! | Armed     | neutral   | new limits | -> Running  | (1)    | -> Idle  |                    |
//! | Running   | reference | `Running`  | `Running`   | -> Ended (2) | sends `Ended`, -> Idle | -> Ended |
//! | Ended     | neutral   | -> Armed   | -> Running  | (1)    | -> Idle  |                    |
//! | Self-test | as asked  | -> Armed   | `NotArmed`  | (1)    | -> Idle  | -> Idle            |
//!
//! 1. Done for the last run, which has ended; `UnknownRun` for others.
//! 2. `UnknownRun` for another run.
//!
//! `ArmFor` is `Arm` with another train of pulses. While the board has not changed to it, there are no pulses.
//!
//! `KeepAlive`, `Status`, `Health`, `Vitals` and `Hello` change no state; `Loopback` begins the self-test of an idle rig, or changes
//! what it does, and is refused as `Running` in other states; `Resend` is refused as `UnknownRun` unless it names the present run
//! or the last one. Conditions of the transitions:
//!
//! | transition | needs                                                                                |
//! |------------|--------------------------------------------------------------------------------------|
//! | -> Armed   | a new request of the session at most 2 s ago; an equal schema hash; a train of pulses that the board makes, of the type that it was armed for since its start; [`Limits`] within the board's for it; every sample of the newest frame in the sensor's range, and the board's supply not too low in it |
//! | -> Self-test | a new request of the session at most 2 s ago; an equal schema hash; no arming for narrow pulses since the start; a pulse within the board's limits; the newest frame shows the pulse line: low, and high in the first sample where there was a pulse; the supply not too low |
//! | -> Running | a new request of the session at most 2 s and one lease ago; a reference that is well formed, fits the frame index and stays within the limits; a run number other than the last; sensor and supply as for arming |
//!
//! The self-test ends as well with three frames in a row that do not show the pulse line.
//!
//! # Leases
//!
//! Every admitted request of the open session, repeated ones included, begins a new lease, but for one that came too
//! late to arm or to start. The frame in which the
//! lease lapses ends the run, and the next frame is at neutral.
//!
//! During the lease the session holds the rig, unless the rig is idle: a `Hello` of another session is answered, but
//! opens no session. So a second program cannot disturb a run, nor the frames that are sent again after its end. A
//! host that is gone can be replaced once its lease has lapsed.

use crate::board::{CapturedFrame, Identity};
use crate::frame_history::{self, History};
use crate::limits::Limits;
use crate::loopback::{self, SelfTest};
use crate::outbox::{Answer, Item, Outbox};
use crate::run::Run;
use crate::session::{Admission, Session};
use crate::supply_meter::SupplyMeter;
use servoid_protocol::health::Health;
use servoid_protocol::hello::Text16;
use servoid_protocol::lease::LEASE_S;
use servoid_protocol::loopback::{Loopback, LoopbackFrame, Vitals};
use servoid_protocol::message::{
    Activity, Arm, ArmFor, Command, EndReason, Ended, Outcome, Refusal, Request, RigMessage, Start,
    Status,
};
use servoid_protocol::pulse_train::PulseType;
use servoid_protocol::schema::{PROTOCOL_VERSION, SCHEMA_HASH};
use servoid_protocol::{Hello, PulseTrain, PulseWidth};

/// The outcome of a request that came so late that its host may be gone.
const TOO_LATE: Outcome = Outcome::Refused(Refusal::LeaseLapsed);

/// The state of the rig.
#[derive(Debug)]
#[cfg_attr(test, derive(Clone))]
enum State {
    Idle,
    Armed(Limits),
    Running(Limits, Run),
    Ended(Limits, Ended),
    SelfTest(SelfTest),
}

/// The rig.
#[derive(Debug)]
#[cfg_attr(test, derive(Clone))]
pub struct Rig {
    identity: Identity,
    /// The train of pulses that the rig is armed for; the usual one while it is not.
    train: PulseTrain,
    /// The type of the first train that it was armed for: it makes no other pulses until its next start.
    held: Option<PulseType>,
    state: State,
    session: Session,
    history: History,
    outbox: Outbox,
    newest: Option<CapturedFrame>,
    /// Number of the newest frame at the last request that renewed the lease.
    heard_at: u32,
    /// The same at the last one that was no copy of the one before.
    newly_heard_at: u32,
    frames_lost: u32,
    rejects: u32,
    supply: SupplyMeter,
    vitals: Vitals,
    wants_vitals: bool,
}

impl Rig {
    /// A rig on the board `identity`: idle, without a session.
    #[inline(never)] // inlined, its 6 KB would stay on the stack of the loop that owns it
    pub fn new(identity: &Identity) -> Self {
        Self {
            identity: *identity,
            train: PulseTrain::USUAL,
            held: None,
            state: State::Idle,
            session: Session::default(),
            history: History::default(),
            outbox: Outbox::default(),
            newest: None,
            heard_at: 0,
            newly_heard_at: 0,
            frames_lost: 0,
            rejects: 0,
            supply: SupplyMeter::default(),
            vitals: Vitals::default(),
            wants_vitals: false,
        }
    }

    /// Takes a captured frame; returns the pulse for the next one.
    pub fn on_frame(&mut self, frame: &CapturedFrame) -> Option<PulseWidth> {
        self.supply.take(frame.supply);
        if let Some(before) = self.newest.replace(*frame) {
            let lost = frame.lost_since(before.number);
            self.frames_lost = self.frames_lost.saturating_add(lost);
        }
        if let State::Running(limits, run) = &mut self.state {
            let reason = run.on_frame(frame, limits, &mut self.history).or_else(|| {
                has_lapsed(frame, self.heard_at, limits).then_some(EndReason::LeaseLapsed)
            });
            self.outbox.measure_backlog(&self.history);
            if let Some(reason) = reason {
                self.end(reason);
            }
        }
        let full_scale = self.identity.full_scale;
        if let State::SelfTest(test) = &mut self.state
            && !test.goes_on(frame, self.heard_at, full_scale)
        {
            self.state = State::Idle;
        }
        // No pulse comes at another rate, nor before the board has let go of the train before.
        if frame.train != self.train {
            return None;
        }
        match &self.state {
            State::Idle => None,
            State::SelfTest(test) => Some(test.asked.pulse),
            State::Armed(limits) | State::Ended(limits, _) => Some(limits.neutral),
            State::Running(limits, run) => Some(run.next_pulse(limits)),
        }
    }

    /// Executes a request and queues its answer.
    pub fn on_request(&mut self, request: &Request) {
        if request.command == Command::Unused {
            self.count_rejects(1);
            return;
        }
        let reply = |outcome| Answer::Reply {
            session: request.session,
            id: request.id,
            outcome,
        };
        let outcome = match self.session.admit(request, self.is_held()) {
            Admission::Refused(refusal) => {
                let answer = reply(Outcome::Refused(refusal));
                match refusal {
                    Refusal::UnknownSession => self.outbox.visitor = Some(answer),
                    _ => self.outbox.answer(answer),
                }
                return;
            }
            Admission::Visit => {
                self.outbox.visitor = Some(Answer::Hello);
                return;
            }
            Admission::Again(outcome) => outcome,
            Admission::New => {
                if !self.session.is_open(request.session) {
                    self.outbox.new_session();
                }
                let outcome = match self.carry_out(&request.command) {
                    Ok(()) => Outcome::Done,
                    Err(refusal) => Outcome::Refused(refusal),
                };
                self.session.settle(request, outcome);
                if outcome != TOO_LATE {
                    self.newly_heard_at = self.newest_number();
                }
                outcome
            }
        };
        // What the line held back for so long is no sign of life.
        if outcome != TOO_LATE {
            self.heard_at = self.newest_number();
        }
        self.wants_vitals |= request.command == Command::Vitals;
        self.outbox.answer(match (request.command, outcome) {
            (Command::Hello, _) => Answer::Hello,
            (Command::Status, _) => Answer::Status,
            (Command::Health, _) => Answer::Health,
            (Command::Vitals, _) => Answer::Vitals,
            (Command::Loopback(_), Outcome::Done) => Answer::Loopback,
            _ => reply(outcome),
        });
    }

    /// The train of pulses that the rig is armed for; the usual one while it is not.
    pub fn train(&self) -> PulseTrain {
        self.train
    }

    /// The instant of the probe that the self-test asks for (µs after the frame edge).
    pub fn probe_us(&self) -> Option<u16> {
        match (&self.state, &self.newest) {
            // Its instants are those of the usual train.
            (State::SelfTest(test), Some(newest)) if newest.train == self.train => {
                Some(test.asked.probe_us)
            }
            _ => None,
        }
    }

    /// Whether the host has asked for what the board measures of its processor: see [`Self::set_vitals`].
    pub fn wants_vitals(&self) -> bool {
        self.wants_vitals
    }

    /// Takes what the board measures of its processor, for the answer that waits.
    pub fn set_vitals(&mut self, vitals: Vitals) {
        self.wants_vitals = false;
        self.vitals = vitals;
    }

    /// Counts `rejects` more unreadable requests.
    pub fn count_rejects(&mut self, rejects: u32) {
        self.rejects = self.rejects.saturating_add(rejects);
    }

    /// Whether pulses are on.
    pub fn is_armed(&self) -> bool {
        !matches!(self.state, State::Idle)
    }

    /// Offers the waiting messages to `take`, one after the other, until none is left or `take` returns `false`. That
    /// message is offered again the next time.
    pub fn send(&mut self, mut take: impl FnMut(&RigMessage) -> bool) {
        while let Some(item) = self.outbox.next(&self.history) {
            let message = match item {
                Item::Answer(answer) | Item::Visitor(answer) => self.message(answer),
                Item::Ended(ended) => RigMessage::Ended(ended),
                Item::Again(frame) | Item::Live(frame) => RigMessage::Frame(frame),
            };
            if !take(&message) {
                return;
            }
            self.outbox.sent(&item);
        }
    }

    fn message(&self, answer: Answer) -> RigMessage {
        match answer {
            Answer::Hello => RigMessage::Hello(self.hello()),
            Answer::Status => RigMessage::Status(self.status()),
            Answer::Health => RigMessage::Health(self.health()),
            Answer::Vitals => RigMessage::Vitals(Vitals {
                frames: self.newest.map_or(0, |frame| frame.number.wrapping_add(1)),
                ..self.vitals
            }),
            Answer::Loopback => RigMessage::Loopback(self.loopback_frame()),
            Answer::Reply {
                session,
                id,
                outcome,
            } => RigMessage::Reply {
                session,
                id,
                outcome,
            },
        }
    }

    fn hello(&self) -> Hello {
        let (identity, train) = (&self.identity, &self.train);
        let [shortest, longest] = train.pulses.board_limits();
        Hello {
            protocol_version: PROTOCOL_VERSION,
            schema_hash: SCHEMA_HASH,
            board: identity.board,
            build: Text16::new(env!("CARGO_PKG_VERSION")),
            unique_id: identity.unique_id,
            clock: identity.clock,
            reset_cause: identity.reset_cause,
            frame_us: train.frame_us(),
            sample_us: train.sample_us().into(),
            first_sample_us: if *train == PulseTrain::USUAL {
                identity.first_sample_us
            } else {
                train.first_sample_us()
            },
            aperture_us: identity.aperture_us,
            oversampling: identity.oversampling,
            full_scale_counts: identity.full_scale.0,
            shortest_pulse_us: shortest.0,
            longest_pulse_us: longest.0,
            history_frames: frame_history::CAPACITY as u16,
        }
    }

    fn newest_number(&self) -> u32 {
        self.newest.map_or(0, |frame| frame.number)
    }

    /// Requires a host that was alive a moment ago: within `lease_frames`, and within [`LEASE_S`].
    ///
    /// A line may hold back what a host said last, and deliver it when the host is gone. A copy of a request is no
    /// proof of life, since the line may hold back that too.
    fn require_alive(&self, lease_frames: u16) -> Result<(), Refusal> {
        let silent = self.newest_number().wrapping_sub(self.newly_heard_at);
        if silent < u32::from(lease_frames.min(self.train.frames_in(LEASE_S))) {
            Ok(())
        } else {
            Err(Refusal::LeaseLapsed)
        }
    }

    /// Whether the open session holds the rig: it has armed it, and its lease has not lapsed.
    fn is_held(&self) -> bool {
        let limits = match &self.state {
            State::Idle => return false,
            State::SelfTest(_) => {
                let newest = self.newest.as_ref();
                return newest.is_some_and(|frame| loopback::is_held(frame, self.heard_at));
            }
            State::Armed(limits) | State::Running(limits, _) | State::Ended(limits, _) => limits,
        };
        let newest = self.newest.as_ref();
        newest.is_some_and(|frame| !has_lapsed(frame, self.heard_at, limits))
    }

    fn status(&self) -> Status {
        let newest = self.newest.as_ref();
        Status {
            activity: match &self.state {
                State::Idle => Activity::Idle,
                State::Armed(_) => Activity::Armed,
                State::Running(_, run) => run.activity(),
                State::Ended(_, ended) => Activity::Ended(*ended),
                State::SelfTest(_) => Activity::Loopback,
            },
            sensor: newest
                .and_then(|frame| frame.samples.last().copied())
                .unwrap_or_default(),
            frames_since_start: newest.map_or(0, |frame| frame.number.wrapping_add(1)),
            frames_lost_on_board: self.frames_lost,
            rejects: self.rejects,
            backlog_high_water: self.outbox.backlog_high_water,
        }
    }

    fn loopback_frame(&self) -> LoopbackFrame {
        let newest = self.newest.as_ref();
        let timing = newest.map(|frame| frame.timing).unwrap_or_default();
        LoopbackFrame {
            number: self.newest_number(),
            pulse: newest.and_then(|frame| frame.pulse),
            samples: newest.map(|frame| frame.samples).unwrap_or_default(),
            sampled_us: timing.sampled_us,
            probe: timing.probe,
        }
    }

    fn health(&self) -> Health {
        Health {
            flash_kib: self.identity.chip.flash_kib,
            device: self.identity.chip.device,
            bandgap_at_start: self.supply.at_start,
            bandgap: self.supply.newest,
            low_supply_frames: self.supply.low_frames,
            last_fault: self.identity.last_fault,
        }
    }

    fn carry_out(&mut self, command: &Command) -> Result<(), Refusal> {
        match command {
            Command::Unused
            | Command::Hello
            | Command::Status
            | Command::Health
            | Command::Vitals
            | Command::KeepAlive => Ok(()),
            Command::Loopback(asked) => self.test_itself(asked),
            Command::Arm(arm) => self.arm(PulseTrain::USUAL, arm),
            Command::ArmFor(ArmFor { train, arm }) => self.arm(*train, arm),
            Command::Disarm => {
                self.end(EndReason::Disarmed);
                (self.state, self.train) = (State::Idle, PulseTrain::USUAL);
                Ok(())
            }
            Command::Start(start) => self.start(start),
            Command::Stop { run } => {
                self.require_run(*run)?;
                self.end(EndReason::Stopped);
                Ok(())
            }
            Command::Resend { run, first, count } => {
                self.require_run(*run)?;
                self.outbox.resend(*first..first.saturating_add(*count));
                Ok(())
            }
        }
    }

    fn arm(&mut self, train: PulseTrain, arm: &Arm) -> Result<(), Refusal> {
        if matches!(self.state, State::Running(..)) {
            return Err(Refusal::Running);
        }
        if arm.schema_hash != SCHEMA_HASH {
            return Err(Refusal::SchemaDiffers);
        }
        self.require_alive(u16::MAX)?;
        let limits = Limits::new(arm, &train, self.identity.full_scale)?;
        self.require_type(train.pulses)?;
        self.require_healthy(&limits)?;
        (self.train, self.held) = (train, Some(train.pulses));
        self.state = State::Armed(limits);
        Ok(())
    }

    /// Begins the self-test, or changes what it does.
    fn test_itself(&mut self, asked: &Loopback) -> Result<(), Refusal> {
        if !matches!(self.state, State::Idle | State::SelfTest(_)) {
            return Err(Refusal::Running);
        }
        if asked.schema_hash != SCHEMA_HASH {
            return Err(Refusal::SchemaDiffers);
        }
        self.require_alive(u16::MAX)?;
        self.require_type(PulseTrain::USUAL.pulses)?;
        let newest = self.newest.as_ref().ok_or(Refusal::SensorOutOfRange)?;
        let test = SelfTest::new(*asked, newest, self.identity.full_scale)?;
        self.train = PulseTrain::USUAL;
        self.state = State::SelfTest(test);
        Ok(())
    }

    fn start(&mut self, start: &Start) -> Result<(), Refusal> {
        let limits = match &self.state {
            State::Idle | State::SelfTest(_) => return Err(Refusal::NotArmed),
            State::Running(..) => return Err(Refusal::Running),
            State::Armed(limits) | State::Ended(limits, _) => *limits,
        };
        self.require_alive(limits.lease_frames)?;
        let frames = limits.admit(start)?;
        if self.history.run() == Some(start.run) {
            return Err(Refusal::RunRepeated);
        }
        self.require_healthy(&limits)?;
        self.history.begin(start.run);
        self.outbox.new_run();
        self.state = State::Running(limits, Run::new(*start, frames));
        Ok(())
    }

    /// Ends the present run, if there is one.
    fn end(&mut self, reason: EndReason) {
        if let State::Running(limits, run) = &self.state {
            let (limits, ended) = (*limits, run.ended(reason));
            self.outbox.ended = Some(ended);
            self.state = State::Ended(limits, ended);
        }
    }

    /// Requires the run of the history: the present run or the last one.
    fn require_run(&self, run: u16) -> Result<(), Refusal> {
        if self.history.run() == Some(run) {
            Ok(())
        } else {
            Err(Refusal::UnknownRun)
        }
    }

    /// Requires pulses of the type that the rig was armed for since its start: a servo of the other type may be on its
    /// line still.
    fn require_type(&self, pulses: PulseType) -> Result<(), Refusal> {
        if self.held.is_none_or(|held| held == pulses) {
            Ok(())
        } else {
            Err(Refusal::OtherPulseType)
        }
    }

    /// Requires readings that can be trusted: the newest ones of the sensor and of the supply.
    fn require_healthy(&self, limits: &Limits) -> Result<(), Refusal> {
        if self
            .newest
            .as_ref()
            .is_some_and(|frame| frame.supply.is_low)
        {
            return Err(Refusal::SupplyLow);
        }
        let healthy = |frame: &CapturedFrame| frame.samples.iter().all(|&s| limits.is_healthy(s));
        if self.newest.as_ref().is_some_and(healthy) {
            Ok(())
        } else {
            Err(Refusal::SensorOutOfRange)
        }
    }
}

/// Whether a lease that began with frame `heard_at` has lapsed at `frame`.
fn has_lapsed(frame: &CapturedFrame, heard_at: u32, limits: &Limits) -> bool {
    frame.number.wrapping_sub(heard_at) >= u32::from(limits.lease_frames)
}

#[cfg(test)]
mod tests;
