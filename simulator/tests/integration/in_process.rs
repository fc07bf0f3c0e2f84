//! Whole runs through the byte link, with the firmware's own rig in between.

use servoid_protocol::hello::ClockSource;
use servoid_protocol::message::{Activity, Arm, Ended, Start, Status};
use servoid_protocol::reference::Staircase;
use servoid_protocol::schema::SCHEMA_HASH;
use servoid_protocol::{
    Command, Counts, Decoder, EndReason, Frame, Outcome, PulseWidth, Reference, Request,
    RigMessage, RunCheck, framing,
};
use servoid_simulator::{InProcessRig, SimulatedFrame, SimulationOptions, simulate};
use std::cell::RefCell;
use std::rc::Rc;
use std::time::Duration;

const RUN: u16 = 21;

/// A minimal host.
struct Host {
    rig: InProcessRig,
    /// The frames that the board sampled.
    log: Rc<RefCell<Vec<SimulatedFrame>>>,
    decoder: Decoder,
    id: u16,
    bytes: Vec<u8>,
    frames: Vec<Frame>,
    ended: Option<Ended>,
}

impl Host {
    /// A host that has opened its session.
    fn connect(options: &str) -> Self {
        let options: SimulationOptions = options.parse().unwrap();
        let log = Rc::new(RefCell::new(Vec::new()));
        let seen = log.clone();
        let rig =
            InProcessRig::observed(&options, move |frame| seen.borrow_mut().push(*frame)).unwrap();
        let mut host = Self {
            rig,
            log,
            decoder: Decoder::new(),
            id: 0,
            bytes: Vec::new(),
            frames: Vec::new(),
            ended: None,
        };
        let RigMessage::Hello(hello) = host.ask(Command::Hello) else {
            panic!("no hello");
        };
        assert_eq!(hello.schema_hash, SCHEMA_HASH);
        assert_eq!(hello.clock, ClockSource::Simulated);
        let sensor_gain = options.conditions.sensor_gain;
        assert_eq!(hello.unique_id[4..], sensor_gain.to_le_bytes());
        host
    }

    /// Reads once, for at most 100 ms; keeps frames and ends, returns everything else.
    fn listen(&mut self) -> Vec<RigMessage> {
        let mut buffer = [0; 64];
        let count = self.rig.read(&mut buffer, Duration::from_millis(100));
        self.bytes.extend_from_slice(&buffer[..count]);
        let mut answers = Vec::new();
        for &byte in &buffer[..count] {
            match self.decoder.push(byte) {
                Some(RigMessage::Frame(frame)) => self.frames.push(frame),
                Some(RigMessage::Ended(ended)) => self.ended = Some(ended),
                Some(answer) => answers.push(answer),
                None => {}
            }
        }
        answers
    }

    fn ask(&mut self, command: Command) -> RigMessage {
        let id = self.id;
        self.id += 1;
        let request = Request {
            session: 5,
            id,
            command,
        };
        self.rig
            .write(framing::encode(&request, &mut [0; framing::MAX_WIRE]).unwrap());
        let deadline = self.rig.now() + Duration::from_secs(2);
        while self.rig.now() < deadline {
            if let Some(answer) = self.listen().first() {
                return *answer;
            }
        }
        panic!("no answer to {command:?}");
    }

    fn ask_done(&mut self, command: Command) {
        let outcome = match self.ask(command) {
            RigMessage::Reply { outcome, .. } => Some(outcome),
            _ => None,
        };
        assert_eq!(outcome, Some(Outcome::Done), "{command:?}");
    }

    fn arm_and_start(&mut self, lease_frames: u16, start: Start) {
        self.ask_done(Command::Arm(Arm {
            schema_hash: SCHEMA_HASH,
            neutral: PulseWidth::NEUTRAL,
            shortest: PulseWidth(1000),
            longest: PulseWidth(2000),
            sensor_low: Counts(1600),
            sensor_high: Counts(14_800),
            lease_frames,
        }));
        self.ask_done(Command::Start(start));
    }

    /// Listens, with a sign of life each second, until all frames of the ended run are here.
    fn listen_to_the_end(&mut self) -> Ended {
        let limit = self.rig.now() + Duration::from_secs(60);
        let mut next_sign = self.rig.now();
        while self.rig.now() < limit {
            if let Some(ended) = self.ended
                && self.frames.len() == usize::from(ended.frames)
            {
                return ended;
            }
            if self.rig.now() >= next_sign {
                next_sign += Duration::from_secs(1);
                self.ask_done(Command::KeepAlive);
            }
            self.listen();
        }
        panic!("the run does not end");
    }

    fn status(&mut self) -> Status {
        match self.ask(Command::Status) {
            RigMessage::Status(status) => status,
            other => panic!("{other:?}"),
        }
    }

    /// The board's own log of the run: its `count` frames from the first one that is not neutral,
    /// less the pre-roll.
    fn logged(&self, pre_roll: usize, count: usize) -> Vec<SimulatedFrame> {
        let log = self.log.borrow();
        let neutral = Some(PulseWidth::NEUTRAL);
        let moves = log
            .iter()
            .position(|f| f.pulse.is_some() && f.pulse != neutral)
            .unwrap();
        log[moves - pre_roll..][..count].to_vec()
    }
}

fn start(reference: Staircase) -> Start {
    Start {
        run: RUN,
        pre_roll_frames: 25,
        reference: Reference::Staircase(reference),
        post_roll_frames: 30,
    }
}

fn check_of(frames: &[Frame]) -> u32 {
    let mut check = RunCheck::new();
    frames.iter().for_each(|frame| check.update(frame));
    check.value()
}

#[test]
fn the_papers_run_arrives_whole_and_is_what_the_board_sampled() {
    for servo in ["bench", "aircraft", "linear"] {
        let mut host = Host::connect(&format!("{servo}?seed=7"));
        let start = start(Staircase::PAPER);
        host.arm_and_start(100, start);
        let ended = host.listen_to_the_end();
        assert_eq!((ended.run, ended.reason), (RUN, EndReason::Complete));
        assert_eq!(usize::from(ended.frames), 25 + 360 + 30);
        assert_eq!(ended.frames_lost_on_board, 0);
        assert_eq!(ended.check, check_of(&host.frames));
        let logged = host.logged(25, host.frames.len());
        for (index, (frame, truth)) in (0u32..).zip(host.frames.iter().zip(&logged)) {
            let offset = start.offset_us(index).unwrap();
            assert_eq!((frame.run, u32::from(frame.index)), (RUN, index));
            assert_eq!(PulseWidth::NEUTRAL.offset_by(offset), Some(frame.pulse));
            assert_eq!(truth.pulse, Some(frame.pulse));
            assert_eq!(truth.samples, frame.samples);
        }
        assert_eq!(host.decoder.rejects().total(), 0);
        // One PWM frame for each 20 ms of simulated time.
        let edges = host.rig.now().as_millis() / 20;
        assert_eq!(host.log.borrow().len() as u128, edges);
    }
}

#[test]
fn the_short_way_round_gives_the_same_samples() {
    let options = "aircraft?seed=3&scatter";
    let mut host = Host::connect(options);
    host.arm_and_start(100, start(Staircase::PAPER));
    host.listen_to_the_end();
    let log = host.log.borrow();
    let pulses = log.iter().map(|frame| frame.pulse);
    let again: Vec<SimulatedFrame> = simulate(&options.parse().unwrap(), pulses)
        .unwrap()
        .collect();
    assert_eq!(again, *log);
}

#[test]
fn equal_calls_give_equal_bytes() {
    let bytes = |seed: u64| {
        let mut host = Host::connect(&format!("bench?seed={seed}"));
        host.arm_and_start(100, start(Staircase::PAPER));
        host.listen_to_the_end();
        host.bytes
    };
    assert_eq!(bytes(1), bytes(1));
    assert_ne!(bytes(1), bytes(2));
}

#[test]
fn a_silent_host_loses_the_run_after_the_lease_in_simulated_time() {
    let mut host = Host::connect("bench");
    host.arm_and_start(50, start(Staircase::PAPER));
    while host.ended.is_none() {
        host.listen();
        assert!(host.rig.now() < Duration::from_secs(3), "no end");
    }
    let ended = host.ended.unwrap();
    assert_eq!(ended.reason, EndReason::LeaseLapsed);
    // The lease counts from the request; the run begins within the next two frames.
    assert!((48..=50).contains(&ended.frames), "{}", ended.frames);
    let pulse = host.log.borrow().last().unwrap().pulse;
    assert_eq!(pulse, Some(PulseWidth::NEUTRAL));
    assert!(matches!(host.status().activity, Activity::Ended(_)));
}

#[test]
fn a_broken_sensor_ends_the_run() {
    for fault in ["open@2", "short@2"] {
        let mut host = Host::connect(&format!("bench?fault={fault}"));
        host.arm_and_start(200, start(Staircase::PAPER));
        let ended = host.listen_to_the_end();
        assert_eq!(ended.reason, EndReason::SensorOutOfRange, "{fault}");
        let expected = if fault.starts_with("open") { 0 } else { 16_380 };
        let broken = host.frames.last().unwrap().samples[9];
        // The ADC's own noise goes on: 4 codes of sd 1.09 sum to sd 2.2; seven of those.
        assert!(broken.0.abs_diff(expected) < 15, "{broken:?}");
    }
}

#[test]
fn a_line_too_slow_for_the_frames_makes_them_wait_and_loses_none() {
    // 600 bytes/s for 50 frames/s of 20 to 40 bytes.
    let mut host = Host::connect("linear?baud=6000");
    let short = Staircase {
        longest_hold_frames: 10,
        ..Staircase::PAPER
    };
    host.arm_and_start(100, start(short));
    let ended = host.listen_to_the_end();
    assert_eq!(ended.reason, EndReason::Complete);
    assert_eq!(ended.check, check_of(&host.frames));
    let indices: Vec<u16> = host.frames.iter().map(|frame| frame.index).collect();
    assert_eq!(indices, (0..25 + 30 + 30).collect::<Vec<u16>>());
    let waited = host.status().backlog_high_water;
    assert!(waited > 20, "only {waited} frames waited");
}

#[test]
fn a_disarmed_servo_gets_no_pulses() {
    let mut host = Host::connect("bench?baud=unlimited");
    host.arm_and_start(100, start(Staircase::PAPER));
    host.ask_done(Command::Disarm);
    for _ in 0..10 {
        host.listen();
    }
    assert_eq!(host.log.borrow().last().unwrap().pulse, None);
    assert_eq!(host.status().activity, Activity::Idle);
}

#[test]
fn a_read_without_an_answer_takes_exactly_its_time_out() {
    let mut rig = InProcessRig::new(&"bench".parse().unwrap()).unwrap();
    let mut buffer = [0; 10];
    for (ms, now) in [(0, 0), (7, 7), (130, 137), (20, 157)] {
        assert_eq!(rig.read(&mut buffer, Duration::from_millis(ms)), 0);
        assert_eq!(rig.now(), Duration::from_millis(now));
    }
}

#[test]
fn options_made_by_hand_are_checked_too() {
    let mut options: SimulationOptions = "bench".parse().unwrap();
    options.conditions.supply = f64::NAN;
    let error = InProcessRig::new(&options).err().unwrap();
    assert_eq!(
        error.to_string(),
        "the option `supply` must be a number above 0"
    );
}
