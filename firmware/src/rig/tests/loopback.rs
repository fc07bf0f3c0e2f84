//! The self-test: pulses only while the board sees them.

use super::*;
use servoid_protocol::lease::LEASE_FRAMES;
use servoid_protocol::loopback::Probe;

const LOW: [Counts; 10] = [Counts(3); 10];

fn asked() -> Loopback {
    Loopback {
        schema_hash: SCHEMA_HASH,
        pulse: PulseWidth(1_200),
        probe_us: 1_180,
    }
}

/// The samples of a board that is wired to itself, with this pulse on the line.
fn own(pulse: Option<PulseWidth>) -> [Counts; 10] {
    let mut samples = LOW;
    samples[0] = Counts(if pulse.is_some() { 10_843 } else { 3 });
    samples
}

impl Bench {
    fn looped() -> Self {
        let mut bench = Self::connected();
        bench.looped_frames(1);
        bench
    }

    fn looped_frames(&mut self, count: usize) {
        for _ in 0..count {
            self.frame_with(self.on_line, own(self.on_line));
        }
    }

    /// The frame that answers, or the refusal.
    fn test_itself(&mut self, asked: Loopback) -> Result<LoopbackFrame, Refusal> {
        self.sent.clear();
        let outcome = self.request(Command::Loopback(asked));
        match (outcome, self.sent.first()) {
            (Some(Outcome::Refused(refusal)), _) => Err(refusal),
            (_, Some(RigMessage::Loopback(frame))) => Ok(*frame),
            other => panic!("{other:?}"),
        }
    }
}

#[test]
fn a_board_that_is_wired_to_itself_makes_the_pulses_and_shows_its_frames() {
    let mut bench = Bench::looped();
    assert_eq!(bench.test_itself(asked()).unwrap().pulse, None);
    assert_eq!(bench.rig.probe_us(), Some(1_180));
    let probe = Probe {
        at_us: 1_180,
        code: 2_700,
    };
    bench.timing = FrameTiming {
        sampled_us: 18_585,
        probe: Some(probe),
    };
    bench.looped_frames(2);
    assert_eq!(bench.on_line, Some(PulseWidth(1_200)));
    let longer = Loopback {
        pulse: PulseWidth(1_800),
        ..asked()
    };
    let frame = bench.test_itself(longer).unwrap();
    assert_eq!(frame.pulse, Some(PulseWidth(1_200)));
    assert_eq!((frame.sampled_us, frame.probe), (18_585, Some(probe)));
    assert_eq!(frame.samples, own(frame.pulse));
    bench.looped_frames(1);
    assert_eq!(bench.on_line, Some(PulseWidth(1_800)));
    assert_eq!(bench.status().activity, Activity::Loopback);
    assert_eq!(
        bench.refused(Command::Start(short_run(1))),
        Refusal::NotArmed
    );
    bench.request(Command::Disarm);
    bench.looped_frames(1);
    assert_eq!((bench.on_line, bench.rig.probe_us()), (None, None));
}

/// A rig with its sensor makes no pulse; a servo without one gets three at most.
#[test]
fn pulses_end_where_the_board_does_not_see_them() {
    let mut sensor = Bench::connected();
    assert_eq!(
        sensor.test_itself(asked()).unwrap_err(),
        Refusal::SensorOutOfRange
    );
    sensor.frame();
    assert_eq!(sensor.on_line, None);

    let mut open = Bench::looped();
    open.test_itself(asked()).unwrap();
    let mut pulses = 0;
    for _ in 0..10 {
        open.frame_with(open.on_line, LOW);
        pulses += u32::from(open.on_line.is_some());
    }
    assert_eq!((open.on_line, pulses), (None, 3));
}

#[test]
fn the_self_test_ends_with_its_host_and_with_the_supply() {
    let mut bench = Bench::looped();
    bench.test_itself(asked()).unwrap();
    bench.looped_frames(usize::from(LEASE_FRAMES) - 1);
    assert_eq!(bench.on_line, Some(PulseWidth(1_200)));
    bench.looped_frames(1);
    assert_eq!(bench.on_line, None);

    let mut bench = Bench::looped();
    bench.test_itself(asked()).unwrap();
    bench.looped_frames(2);
    bench.supply.is_low = true;
    bench.looped_frames(1);
    assert_eq!(bench.on_line, None);
    assert_eq!(bench.test_itself(asked()).unwrap_err(), Refusal::SupplyLow);
}

#[test]
fn what_the_board_cannot_do_is_refused() {
    let mut bench = Bench::looped();
    type Change = fn(&mut Loopback);
    let bad: [Change; 5] = [
        |l| l.pulse = PulseWidth(799),
        |l| l.pulse = PulseWidth(2_201),
        |l| l.probe_us = 0,
        |l| l.probe_us = 2_500,
        |l| l.probe_us = 20_000,
    ];
    for change in bad {
        let mut loopback = asked();
        change(&mut loopback);
        assert_eq!(
            bench.test_itself(loopback).unwrap_err(),
            Refusal::BadLimits,
            "{loopback:?}"
        );
    }
    let other = Loopback {
        schema_hash: SCHEMA_HASH ^ 1,
        ..asked()
    };
    assert_eq!(
        bench.test_itself(other).unwrap_err(),
        Refusal::SchemaDiffers
    );
    let mut armed = Bench::armed();
    assert_eq!(armed.test_itself(asked()).unwrap_err(), Refusal::Running);
}

#[test]
fn vitals_are_those_of_the_board_when_it_was_asked() {
    let mut bench = Bench::connected();
    assert!(!bench.rig.wants_vitals());
    let request = Request {
        session: 1,
        id: bench.id.wrapping_add(1),
        command: Command::Vitals,
    };
    bench.rig.on_request(&request);
    assert!(bench.rig.wants_vitals());
    let vitals = Vitals {
        frames: 0,
        awake_us: 7,
        stack_bytes: 10_240,
        stack_unused: 3_000,
    };
    bench.rig.set_vitals(vitals);
    assert!(!bench.rig.wants_vitals());
    bench.flush();
    let frames = bench.number;
    assert_eq!(
        bench.sent.last(),
        Some(&RigMessage::Vitals(Vitals { frames, ..vitals }))
    );
}
