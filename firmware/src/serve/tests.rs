use super::*;
use crate::board::{CapturedFrame, ChipIdentity, FrameTiming, Identity, Supply};
use core::future::poll_fn;
use servoid_protocol::hello::{ClockSource, ResetCause, Text16};
use servoid_protocol::message::{Activity, Arm, Command, RigMessage};
use servoid_protocol::schema::SCHEMA_HASH;
use servoid_protocol::{Counts, PulseTrain, PulseWidth};
use std::cell::RefCell;
use std::collections::VecDeque;
use std::pin::pin;
use std::rc::Rc;

/// The calls to the scripted board and link, in order.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Event {
    Pulse(Option<u16>),
    Fed,
    Armed(bool),
    Sent(RigMessage),
}

#[derive(Default)]
struct Script {
    frames: VecDeque<CapturedFrame>,
    bytes: VecDeque<u8>,
    room: usize,
    events: Vec<Event>,
    decoder: Decoder,
}

type Shared = Rc<RefCell<Script>>;
struct ScriptedBoard(Shared);
struct ScriptedLink(Shared);

impl Board for ScriptedBoard {
    fn identity(&self) -> Identity {
        Identity {
            board: Text16::new("scripted"),
            unique_id: [0; 12],
            clock: ClockSource::Simulated,
            reset_cause: ResetCause::PowerOn,
            first_sample_us: 500,
            aperture_us: 0,
            oversampling: 4,
            full_scale: Counts(16_380),
            chip: ChipIdentity::default(),
            last_fault: None,
        }
    }

    async fn next_frame(&mut self) -> CapturedFrame {
        poll_fn(|_| match self.0.borrow_mut().frames.pop_front() {
            Some(frame) => Poll::Ready(frame),
            None => Poll::Pending,
        })
        .await
    }

    fn set_train(&mut self, _train: PulseTrain) {}

    fn set_pulse(&mut self, pulse: Option<PulseWidth>) {
        let event = Event::Pulse(pulse.map(|p| p.0));
        self.0.borrow_mut().events.push(event);
    }

    fn feed_watchdog(&mut self) {
        self.0.borrow_mut().events.push(Event::Fed);
    }

    fn show_armed(&mut self, armed: bool) {
        let events = &mut self.0.borrow_mut().events;
        let last = events.iter().rev().find(|e| matches!(e, Event::Armed(_)));
        if last != Some(&Event::Armed(armed)) {
            events.push(Event::Armed(armed));
        }
    }
}

impl Link for ScriptedLink {
    async fn receive(&mut self, buffer: &mut [u8]) -> usize {
        poll_fn(|_| {
            let bytes = &mut self.0.borrow_mut().bytes;
            let count = bytes.len().min(buffer.len());
            for (slot, byte) in buffer.iter_mut().zip(bytes.drain(..count)) {
                *slot = byte;
            }
            if count == 0 {
                Poll::Pending
            } else {
                Poll::Ready(count)
            }
        })
        .await
    }

    fn try_send(&mut self, bytes: &[u8]) -> bool {
        let script = &mut *self.0.borrow_mut();
        if bytes.len() > script.room {
            return false;
        }
        script.room -= bytes.len();
        let messages = bytes.iter().filter_map(|&b| script.decoder.push(b));
        script.events.extend(messages.map(Event::Sent));
        true
    }
}

fn frame(number: u32) -> CapturedFrame {
    CapturedFrame {
        number,
        train: PulseTrain::USUAL,
        pulse: None,
        samples: [Counts(8_000); 10],
        supply: Supply::default(),
        timing: FrameTiming::default(),
    }
}

fn wire(id: u16, command: Command) -> Vec<u8> {
    let request = Request {
        session: 1,
        id,
        command,
    };
    let mut buffer = [0; framing::MAX_WIRE];
    framing::encode(&request, &mut buffer).unwrap().to_vec()
}

/// Serves until everything waits; between the rounds, `next` may put something into the script.
fn play(script: &Shared, mut next: impl FnMut(usize, &mut Script) -> bool) -> Vec<Event> {
    let (mut board, mut link) = (ScriptedBoard(script.clone()), ScriptedLink(script.clone()));
    let mut served = pin!(serve(&mut board, &mut link));
    let mut round = 0;
    while next(round, &mut script.borrow_mut()) {
        assert!(matches!(poll_once(served.as_mut()), Poll::Pending));
        round += 1;
    }
    script.take().events
}

fn sent(events: &[Event]) -> Vec<RigMessage> {
    events
        .iter()
        .filter_map(|event| match event {
            Event::Sent(message) => Some(*message),
            _ => None,
        })
        .collect()
}

fn roomy() -> Shared {
    Rc::new(RefCell::new(Script {
        room: usize::MAX,
        ..Script::default()
    }))
}

#[test]
fn the_watchdog_is_fed_once_for_each_frame_and_not_for_bytes() {
    let script = roomy();
    let events = play(&script, |round, script| {
        match round {
            0 => script.frames.extend((0..3).map(frame)),
            1 => script.bytes.extend(wire(1, Command::Hello)),
            2 => script.bytes.extend([1; 1_000]),
            _ => return false,
        }
        true
    });
    assert_eq!(events.iter().filter(|e| **e == Event::Fed).count(), 3);
    assert!(matches!(sent(&events)[..], [RigMessage::Hello(_)]));
}

#[test]
fn a_pulse_is_set_after_every_frame_and_first_of_all() {
    let script = roomy();
    let arm = Command::Arm(Arm {
        schema_hash: SCHEMA_HASH,
        neutral: PulseWidth(1_500),
        shortest: PulseWidth(1_400),
        longest: PulseWidth(1_600),
        sensor_low: Counts(1_000),
        sensor_high: Counts(15_000),
        lease_frames: 50,
    });
    let events = play(&script, |round, script| {
        match round {
            0 => script.frames.push_back(frame(0)),
            1 => script
                .bytes
                .extend([wire(1, Command::Hello), wire(2, arm)].concat()),
            2 => script.frames.push_back(frame(1)),
            _ => return false,
        }
        true
    });
    let without_messages: Vec<Event> = events
        .into_iter()
        .filter(|event| !matches!(event, Event::Sent(_)))
        .collect();
    assert_eq!(
        without_messages,
        [
            Event::Pulse(None),
            Event::Fed,
            Event::Armed(false),
            Event::Armed(true),
            Event::Pulse(Some(1_500)),
            Event::Fed,
        ]
    );
}

#[test]
fn bytes_are_heard_while_frames_are_always_ready() {
    let script = roomy();
    let events = play(&script, |round, script| {
        script.frames.extend((0..1_000).map(frame));
        script.bytes.extend(wire(1, Command::Hello));
        round == 0
    });
    let frames_before_hello = events
        .iter()
        .take_while(|event| !matches!(event, Event::Sent(_)))
        .filter(|event| **event == Event::Fed)
        .count();
    assert_eq!(frames_before_hello, 1);
}

#[test]
fn what_the_link_cannot_take_is_sent_when_it_can() {
    let script = Rc::new(RefCell::new(Script::default()));
    let events = play(&script, |round, script| {
        match round {
            0 => script.bytes.extend(wire(1, Command::Hello)),
            1 => {
                script.room = 500;
                script.frames.push_back(frame(0));
            }
            _ => return false,
        }
        true
    });
    assert!(matches!(sent(&events)[..], [RigMessage::Hello(_)]));
}

#[test]
fn junk_is_counted_and_the_status_says_so() {
    let script = roomy();
    let events = play(&script, |round, script| {
        match round {
            0 => script.bytes.extend(wire(1, Command::Hello)),
            1 => script.bytes.extend([9, 9, 9, 0, 1, 2, 0]),
            2 => script.bytes.extend(wire(2, Command::Status)),
            _ => return false,
        }
        true
    });
    let [RigMessage::Hello(_), RigMessage::Status(status)] = sent(&events)[..] else {
        panic!("{events:?}");
    };
    assert_eq!((status.rejects, status.activity), (2, Activity::Idle));
}
