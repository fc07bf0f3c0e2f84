//! A client, and the firmware's own rig on a board without a servo, with a line between them.

use crate::line::{Faults, Line};
use servoid_client::{Arrived, Client, ClientError, Connect, Event, RunEnding};
use servoid_firmware::{CapturedFrame, ChipIdentity, FrameTiming, Identity, Rig, Supply};
use servoid_protocol::hello::{ClockSource, ResetCause, Text16};
use servoid_protocol::lease::LEASE_FRAMES;
use servoid_protocol::message::{Arm, ArmFor, Command, EndReason, RigMessage, Start};
use servoid_protocol::reference::{Reference, Staircase};
use servoid_protocol::schema::SCHEMA_HASH;
use servoid_protocol::{Counts, Decoder, Frame, PulseTrain, PulseWidth, Request, framing};
use std::time::Duration;

pub const FRAME: Duration = Duration::from_millis(20);

/// After this much time a conversation counts as hung.
const HANGS: Duration = Duration::from_secs(300);

pub fn ms(milliseconds: u64) -> Duration {
    Duration::from_millis(milliseconds)
}

fn new_rig() -> Rig {
    Rig::new(&Identity {
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
    })
}

pub fn arm() -> Arm {
    Arm {
        schema_hash: SCHEMA_HASH,
        neutral: PulseWidth(1_500),
        shortest: PulseWidth(1_400),
        longest: PulseWidth(1_600),
        sensor_low: Counts(1_000),
        sensor_high: Counts(15_000),
        lease_frames: LEASE_FRAMES,
    }
}

/// [`arm`] with the usual pulses.
pub fn usual() -> ArmFor {
    ArmFor {
        train: PulseTrain::USUAL,
        arm: arm(),
    }
}

/// 30 frames of a staircase, 5 frames of rest before it, and `rest` behind it.
pub fn run(rest: u16) -> Start {
    Start {
        run: 0x5151,
        pre_roll_frames: 5,
        reference: Reference::Staircase(Staircase {
            amplitude_us: 50,
            longest_hold_frames: 10,
            shortest_hold_frames: 5,
            hold_step_frames: 5,
        }),
        post_roll_frames: rest,
    }
}

pub struct Bench {
    rig: Rig,
    decoder: Decoder,
    pulse: Option<PulseWidth>,
    train: PulseTrain,
    pub now: Duration,
    next_edge: Duration,
    pub to_rig: Line,
    pub to_host: Line,
    /// The client is given the time at least so often.
    pub tick: Option<Duration>,
    /// While this lasts, nobody looks at what has come.
    pub host_sleeps: std::ops::Range<Duration>,
    /// The rig is switched off and on at this moment.
    pub reset_at: Option<Duration>,
    /// Messages that the rig sends and that never arrive.
    pub drops: fn(&RigMessage) -> bool,
    /// What becomes of messages of the rig.
    pub alters: fn(RigMessage) -> RigMessage,
    /// What the board sampled.
    pub log: Vec<CapturedFrame>,
    /// What the client sent, and when.
    pub sent: Vec<(Duration, Request)>,
}

impl Bench {
    /// A rig behind a good line.
    pub fn new() -> Self {
        Self::behind(Faults::default(), 0)
    }

    /// A rig behind a line with these faults in both directions.
    pub fn behind(faults: Faults, seed: u64) -> Self {
        Self {
            rig: new_rig(),
            decoder: Decoder::new(),
            pulse: None,
            train: PulseTrain::USUAL,
            now: Duration::ZERO,
            next_edge: FRAME,
            to_rig: Line::new(faults, 2 * seed),
            to_host: Line::new(faults, 2 * seed + 1),
            tick: None,
            host_sleeps: Duration::ZERO..Duration::ZERO,
            reset_at: None,
            drops: |_| false,
            alters: |message| message,
            log: Vec::new(),
            sent: Vec::new(),
        }
    }

    /// A client that opens session 1.
    pub fn connect(&mut self) -> Result<Client, ClientError> {
        self.connect_as(1, false)
    }

    pub fn connect_as(&mut self, session: u16, listens_first: bool) -> Result<Client, ClientError> {
        let connect = Connect {
            session,
            attempts: 12,
            listens_first,
        };
        let mut client = Client::connect(&connect, self.now);
        match self.wait(&mut client).pop() {
            Some(Event::Connected(_)) => Ok(client),
            Some(Event::Failed(error)) => Err(error),
            other => panic!("connecting ends with {other:?}"),
        }
    }

    /// A client that has armed the rig.
    pub fn armed(&mut self) -> Result<Client, ClientError> {
        self.armed_for(usual())
    }

    /// A client that has armed the rig for these pulses.
    pub fn armed_for(&mut self, asked: ArmFor) -> Result<Client, ClientError> {
        let mut client = self.connect()?;
        client.arm(asked, self.now);
        match self.wait(&mut client).pop() {
            Some(Event::Answered(_)) => Ok(client),
            Some(Event::Failed(error)) => Err(error),
            other => panic!("arming ends with {other:?}"),
        }
    }

    /// Lets time go on until the client has nothing more to do; the events.
    pub fn wait(&mut self, client: &mut Client) -> Vec<Event> {
        self.wait_until(client, HANGS)
    }

    /// As [`Bench::wait`], for so long at most.
    pub fn wait_until(&mut self, client: &mut Client, time: Duration) -> Vec<Event> {
        let (end, mut events) = (self.now + time, Vec::new());
        loop {
            self.collect(client, &mut events);
            if client.is_idle() || self.now >= end {
                assert!(time < HANGS || client.is_idle(), "it hangs: {events:?}");
                return events;
            }
            self.go_on(client.next_deadline(), end);
            if self.host_sleeps.contains(&self.now) {
                continue;
            }
            let mut heard = false;
            while let Some(bytes) = self.to_host.receive(self.now) {
                client.handle(&bytes, self.now);
                heard = true;
            }
            if !heard {
                client.handle(&[], self.now);
            }
        }
    }

    /// Lets time go on without a host: what comes for it is lost.
    pub fn pass(&mut self, time: Duration) {
        let end = self.now + time;
        while self.now < end {
            self.go_on(None, end);
            while self.to_host.receive(self.now).is_some() {}
        }
    }

    /// Whether pulses are on.
    pub fn has_pulses(&self) -> bool {
        self.rig.is_armed()
    }

    fn collect(&mut self, client: &mut Client, events: &mut Vec<Event>) {
        while let Some(bytes) = client.poll_transmit() {
            let mut decoder = Decoder::new();
            let request = bytes.iter().find_map(|&byte| decoder.push(byte));
            self.sent
                .push((self.now, request.expect("it is a request")));
            self.to_rig.send(&bytes, self.now);
        }
        events.extend(std::iter::from_fn(|| client.poll_event()));
    }

    /// Lets time go on to whatever comes next, and the rig do its part.
    fn go_on(&mut self, deadline: Option<Duration>, end: Duration) {
        let asleep = self.host_sleeps.contains(&self.now);
        let wakes = [
            deadline.filter(|_| !asleep),
            self.tick.map(|tick| self.now + tick),
            self.to_rig.next_at(),
            self.to_host.next_at().filter(|_| !asleep),
            Some(self.next_edge),
        ];
        let wake = wakes.into_iter().flatten().fold(end, Duration::min);
        self.now = wake.max(self.now);
        if self.reset_at.is_some_and(|at| self.now >= at) {
            self.reset_at = None;
            (self.rig, self.pulse) = (new_rig(), None);
            self.train = PulseTrain::USUAL;
        }
        if self.now == self.next_edge {
            self.frame();
            self.next_edge += Duration::from_micros(self.train.frame_us().into());
        }
        while let Some(bytes) = self.to_rig.receive(self.now) {
            for &byte in &bytes {
                if let Some(request) = self.decoder.push::<Request>(byte) {
                    self.rig.on_request(&request);
                }
            }
        }
        self.send();
    }

    fn frame(&mut self) {
        let number = self.log.len() as u32;
        let sample = |j: u32| Counts(8_000 + ((number * 31 + j * 7) % 1_000) as u16);
        let frame = CapturedFrame {
            number,
            train: self.train,
            pulse: self.pulse,
            samples: std::array::from_fn(|j| sample(j as u32)),
            supply: Supply::default(),
            timing: FrameTiming::default(),
        };
        let pulse = self.rig.on_frame(&frame);
        if self.pulse.is_none() && pulse.is_none() {
            self.train = self.rig.train();
        }
        self.pulse = pulse;
        self.log.push(frame);
    }

    fn send(&mut self) {
        let (now, drops, alters, line) = (self.now, self.drops, self.alters, &mut self.to_host);
        let mut buffer = [0; framing::MAX_WIRE];
        self.rig.send(|message| {
            if !drops(message) {
                line.send(
                    framing::encode(&alters(*message), &mut buffer).unwrap(),
                    now,
                );
            }
            true
        });
    }

    /// Does a request of another host, at once and past the line.
    pub fn other_host(&mut self, session: u16, id: u16, command: Command) {
        let request = Request {
            session,
            id,
            command,
        };
        self.rig.on_request(&request);
    }

    /// Whether the frames among `events` are what the board sampled, each at its place.
    pub fn are_true(&self, events: &[Event]) -> bool {
        let frames = frames(events);
        let same = |frame: &Frame, first: usize| {
            let truth = self.log.get(first + usize::from(frame.index));
            truth.is_some_and(|t| t.pulse == Some(frame.pulse) && t.samples == frame.samples)
        };
        let in_order = frames.is_sorted_by(|a, b| a.index < b.index);
        let fits = |first: usize| frames.iter().all(|frame| same(frame, first));
        in_order && (frames.is_empty() || (0..self.log.len()).any(fits))
    }

    /// How many requests of a kind have been sent.
    pub fn count(&self, kind: fn(&Command) -> bool) -> usize {
        let sent = self.sent.iter();
        sent.filter(|(_, request)| kind(&request.command)).count()
    }
}

pub fn frames(events: &[Event]) -> Vec<Frame> {
    let frame = |event: &Event| match event {
        Event::Frame(frame) => Some(*frame),
        _ => None,
    };
    events.iter().filter_map(frame).collect()
}

/// Requires that the last of `events` ends a run of [`run`] with all of its frames.
#[track_caller]
pub fn require_whole_run(events: &[Event]) {
    let whole = RunEnding {
        reason: EndReason::Complete,
        arrived: Arrived::Whole,
    };
    assert_eq!(events.last(), Some(&Event::RunEnded(whole)));
    assert_eq!(frames(events).len(), 50);
}
