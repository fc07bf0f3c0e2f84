//! Other trains of pulses than the usual one.

use super::*;

fn digital() -> PulseTrain {
    PulseTrain::at_rate(PulseType::Wide, 333.0).unwrap()
}

fn narrow() -> PulseTrain {
    PulseTrain::at_rate(PulseType::Narrow, 560.0).unwrap()
}

fn arm_for(train: PulseTrain) -> Command {
    let arm = match train.pulses {
        PulseType::Wide => arm(),
        PulseType::Narrow => Arm {
            neutral: PulseWidth(760),
            shortest: PulseWidth(660),
            longest: PulseWidth(860),
            ..arm()
        },
    };
    Command::ArmFor(ArmFor { train, arm })
}

fn hello(bench: &mut Bench) -> Hello {
    bench.sent.clear();
    bench.request(Command::Hello);
    match bench.sent.as_slice() {
        [RigMessage::Hello(hello)] => *hello,
        other => panic!("{other:?}"),
    }
}

#[test]
fn hello_states_the_train_that_the_rig_was_armed_for() {
    let mut bench = Bench::connected();
    let stated = |hello: Hello| {
        let timing = (hello.frame_us, hello.sample_us, hello.first_sample_us);
        (timing, [hello.shortest_pulse_us, hello.longest_pulse_us])
    };
    assert_eq!(
        stated(hello(&mut bench)),
        ((20_000, 2_000, 500), [800, 2_200])
    );
    assert_eq!(bench.request(arm_for(narrow())), Some(Outcome::Done));
    assert_eq!(
        stated(hello(&mut bench)),
        ((17_860, 1_786, 300), [400, 1_100])
    );
    bench.request(Command::Disarm);
    assert_eq!(hello(&mut bench).frame_us, 20_000);
}

#[test]
fn pulses_wait_until_the_board_makes_the_train() {
    let mut bench = Bench::armed();
    bench.frame();
    assert_eq!(bench.request(arm_for(digital())), Some(Outcome::Done));
    // The pulse that is on the line ends, a frame has none, and the next train begins.
    let mut seen = Vec::new();
    for _ in 0..4 {
        bench.frame();
        seen.push((bench.train, bench.on_line));
    }
    assert_eq!(
        seen,
        [
            (PulseTrain::USUAL, None),
            (digital(), None),
            (digital(), Some(NEUTRAL)),
            (digital(), Some(NEUTRAL))
        ]
    );
}

/// A run that was asked for in the meantime begins with the first pulse of the new train, and misses nothing.
#[test]
fn a_run_begins_when_its_train_does() {
    let mut bench = Bench::armed();
    bench.request(arm_for(digital()));
    assert_eq!(
        bench.request(Command::Start(short_run(1))),
        Some(Outcome::Done)
    );
    bench.sent.clear();
    for _ in 0..SHORT_RUN_US.len() + 4 {
        bench.frame();
    }
    let frames = bench.sent_frames();
    let pulses: Vec<u16> = frames.iter().map(|frame| frame.pulse.0).collect();
    assert_eq!(pulses, SHORT_RUN_US);
    assert!(frames.iter().map(|frame| frame.index).eq(0..11));
}

#[test]
fn the_board_holds_the_type_of_pulses_until_its_next_start() {
    for (first, other) in [(narrow(), digital()), (digital(), narrow())] {
        let mut bench = Bench::connected();
        assert_eq!(bench.request(arm_for(first)), Some(Outcome::Done));
        bench.frame();
        for disarmed in [false, true] {
            if disarmed {
                bench.request(Command::Disarm);
            }
            let refused = Some(Outcome::Refused(Refusal::OtherPulseType));
            assert_eq!(bench.request(arm_for(other)), refused);
        }
        let usual = bench.request(Command::Arm(arm()));
        assert_eq!(
            usual == Some(Outcome::Done),
            first.pulses == PulseType::Wide
        );
    }
}

/// A refused arming holds nothing: the next one may be of the other type.
#[test]
fn a_refused_arming_holds_no_type() {
    let mut bench = Bench::connected();
    let mismatch = Command::ArmFor(ArmFor {
        train: narrow(),
        arm: arm(),
    });
    let refused = Some(Outcome::Refused(Refusal::BadLimits));
    assert_eq!(bench.request(mismatch), refused);
    assert_eq!(bench.request(Command::Arm(arm())), Some(Outcome::Done));
}

/// Its pulses are wide ones.
#[test]
fn no_self_test_after_narrow_pulses() {
    let mut bench = Bench::connected();
    bench.request(arm_for(narrow()));
    bench.request(Command::Disarm);
    let asked = Loopback {
        schema_hash: SCHEMA_HASH,
        pulse: NEUTRAL,
        probe_us: 700,
    };
    let refused = Some(Outcome::Refused(Refusal::OtherPulseType));
    assert_eq!(bench.request(Command::Loopback(asked)), refused);
}

/// Two seconds, whatever a frame takes.
#[test]
fn a_lease_is_as_long_as_with_the_usual_train() {
    let mut bench = Bench::connected();
    bench.request(arm_for(digital()));
    let stale = |bench: &mut Bench, frames: u16| {
        bench.sign_of_life();
        (0..frames).for_each(|_| bench.frame());
        bench.request(Command::Start(short_run(1)))
    };
    let late = Some(Outcome::Refused(Refusal::LeaseLapsed));
    assert_eq!(stale(&mut bench, 133), late);
    assert_eq!(stale(&mut bench, 132), Some(Outcome::Done));
}
