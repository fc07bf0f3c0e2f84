//! A rig on a bench: a perfect board by default, and a link that takes all bytes.

mod arming;
mod ends;
mod everything;
mod late;
mod link;
mod loopback;
mod losses;
mod model;
mod references;
mod runs;
mod sessions;
mod trains;
mod walk;

use super::*;
use crate::board::{ChipIdentity, FrameTiming, Supply};
use servoid_protocol::Counts;
use servoid_protocol::hello::{ClockSource, ResetCause};
use servoid_protocol::lease::LONGEST_LEASE_S;
use servoid_protocol::message::{Frame, RunCheck};
use servoid_protocol::reference::{Reference, Staircase};

const HEALTHY: [Counts; 10] = [Counts(8_000); 10];
const SICK: Counts = Counts(100);
const NEUTRAL: PulseWidth = PulseWidth(1_500);
/// The longest that is granted.
const LEASE: u16 = PulseTrain::USUAL.frames_in(LONGEST_LEASE_S);

fn identity() -> Identity {
    Identity {
        board: Text16::new("bench"),
        unique_id: [7; 12],
        clock: ClockSource::Simulated,
        reset_cause: ResetCause::PowerOn,
        first_sample_us: 500,
        aperture_us: 84,
        oversampling: 4,
        full_scale: Counts(16_380),
        chip: ChipIdentity::default(),
        last_fault: None,
    }
}

fn arm() -> Arm {
    Arm {
        schema_hash: SCHEMA_HASH,
        neutral: NEUTRAL,
        shortest: PulseWidth(1_400),
        longest: PulseWidth(1_600),
        sensor_low: Counts(1_000),
        sensor_high: Counts(15_000),
        lease_frames: LEASE,
    }
}

/// +50 µs for 2 frames, -50 µs for 2 frames, then the same for 1 frame each: 6 frames.
fn short_run(run: u16) -> Start {
    Start {
        run,
        pre_roll_frames: 2,
        reference: Reference::Staircase(Staircase {
            amplitude_us: 50,
            longest_hold_frames: 2,
            shortest_hold_frames: 1,
            hold_step_frames: 1,
        }),
        post_roll_frames: 3,
    }
}

const SHORT_RUN_US: [u16; 11] = [
    1500, 1500, 1550, 1550, 1450, 1450, 1550, 1450, 1500, 1500, 1500,
];

/// A rig with a perfect board by default, and a link that takes all bytes.
#[derive(Clone)]
struct Bench {
    rig: Rig,
    number: u32,
    on_line: Option<PulseWidth>,
    /// The train that the board makes.
    train: PulseTrain,
    id: u16,
    sent: Vec<RigMessage>,
    /// The board's supply in the next frames.
    supply: Supply,
    /// What the board sees of its timing in them.
    timing: FrameTiming,
}

impl Bench {
    fn new() -> Self {
        Self {
            rig: Rig::new(&identity()),
            number: 0,
            supply: Supply::default(),
            timing: FrameTiming::default(),
            on_line: None,
            train: PulseTrain::USUAL,
            id: 0,
            sent: Vec::new(),
        }
    }

    /// In session 1 and with a frame caught.
    fn connected() -> Self {
        let mut bench = Self::new();
        bench.frame();
        bench.request(Command::Hello);
        bench.sent.clear();
        bench
    }

    fn armed() -> Self {
        let mut bench = Self::connected();
        assert_eq!(bench.request(Command::Arm(arm())), Some(Outcome::Done));
        bench.frame();
        assert_eq!(bench.on_line, Some(NEUTRAL));
        bench.sent.clear();
        bench
    }

    /// With `start` accepted and the frame under way at that time caught: the next one is frame 0.
    fn running(start: Start) -> Self {
        let mut bench = Self::armed();
        assert_eq!(bench.request(Command::Start(start)), Some(Outcome::Done));
        bench.frame();
        bench.sent.clear();
        bench
    }

    fn frame(&mut self) {
        self.frame_with(self.on_line, HEALTHY);
    }

    fn frames(&mut self, count: usize) {
        for _ in 0..count {
            self.frame();
        }
    }

    /// The host is alive, and its sign of life is answered later.
    fn sign_of_life(&mut self) {
        self.id = self.id.wrapping_add(1);
        self.rig.on_request(&Request {
            session: 1,
            id: self.id,
            command: Command::KeepAlive,
        });
    }

    /// Frames with a host that renews its lease.
    fn frames_alive(&mut self, count: usize) {
        for frame in 0..count {
            if frame % usize::from(LEASE / 2) == 0 {
                self.sign_of_life();
            }
            self.frame();
        }
    }

    /// A frame in which `applied` was on the line, and after it what the rig asks for.
    fn frame_with(&mut self, applied: Option<PulseWidth>, samples: [Counts; 10]) {
        self.on_line = self.rig.on_frame(&CapturedFrame {
            number: self.number,
            train: self.train,
            pulse: applied,
            samples,
            supply: self.supply,
            timing: self.timing,
        });
        if applied.is_none() && self.on_line.is_none() {
            self.train = self.rig.train();
        }
        self.number = self.number.wrapping_add(1);
        self.flush();
    }

    /// Frames while the link takes nothing to the host, which is alive.
    fn frames_unsent(&mut self, count: usize) {
        for frame in 0..count {
            if (frame + 1) % usize::from(LEASE / 2) == 0 {
                self.sign_of_life();
            }
            self.on_line = self.rig.on_frame(&CapturedFrame {
                number: self.number,
                train: self.train,
                pulse: self.on_line,
                samples: HEALTHY,
                supply: Supply::default(),
                timing: self.timing,
            });
            self.number = self.number.wrapping_add(1);
        }
    }

    /// Frames that the board does not catch.
    fn lose(&mut self, count: u32) {
        self.number = self.number.wrapping_add(count);
    }

    fn flush(&mut self) {
        let sent = &mut self.sent;
        self.rig.send(|message| {
            sent.push(*message);
            true
        });
    }

    /// A new request of session 1; returns the outcome if there is a reply.
    fn request(&mut self, command: Command) -> Option<Outcome> {
        self.id = self.id.wrapping_add(1);
        self.raw_request(1, self.id, command)
    }

    fn raw_request(&mut self, session: u16, id: u16, command: Command) -> Option<Outcome> {
        let already = self.sent.len();
        self.rig.on_request(&Request {
            session,
            id,
            command,
        });
        self.flush();
        self.sent[already..]
            .iter()
            .find_map(|message| match message {
                RigMessage::Reply {
                    session: s,
                    id: i,
                    outcome,
                } => {
                    assert_eq!((*s, *i), (session, id));
                    Some(*outcome)
                }
                _ => None,
            })
    }

    fn refused(&mut self, command: Command) -> Refusal {
        match self.request(command) {
            Some(Outcome::Refused(refusal)) => refusal,
            other => panic!("{command:?} gave {other:?}"),
        }
    }

    fn status(&mut self) -> Status {
        self.request(Command::Status);
        self.sent
            .iter()
            .rev()
            .find_map(|message| match message {
                RigMessage::Status(status) => Some(*status),
                _ => None,
            })
            .unwrap()
    }

    fn sent_frames(&self) -> Vec<Frame> {
        self.sent
            .iter()
            .filter_map(|message| match message {
                RigMessage::Frame(frame) => Some(*frame),
                _ => None,
            })
            .collect()
    }

    fn sent_pulses(&self) -> Vec<u16> {
        self.sent_frames().iter().map(|f| f.pulse.0).collect()
    }

    fn ends(&self) -> Vec<Ended> {
        self.sent
            .iter()
            .filter_map(|message| match message {
                RigMessage::Ended(ended) => Some(*ended),
                _ => None,
            })
            .collect()
    }

    fn only_end(&self) -> Ended {
        let ends = self.ends();
        assert_eq!(ends.len(), 1, "{ends:?}");
        ends[0]
    }
}

fn check_of(frames: &[Frame]) -> u32 {
    let mut check = RunCheck::new();
    frames.iter().for_each(|frame| check.update(frame));
    check.value()
}
