//! Arming for other pulses than the usual ones.

use crate::bench::{Bench, arm, require_whole_run, run, usual};
use servoid_client::{ClientError, Event};
use servoid_protocol::message::{Arm, ArmFor, Refusal, RigMessage};
use servoid_protocol::pulse_train::PulseType;
use servoid_protocol::{PulseTrain, PulseWidth};

fn narrow() -> ArmFor {
    ArmFor {
        train: PulseTrain::at_rate(PulseType::Narrow, 560.0).unwrap(),
        arm: Arm {
            neutral: PulseWidth(760),
            shortest: PulseWidth(660),
            longest: PulseWidth(860),
            ..arm()
        },
    }
}

fn digital() -> ArmFor {
    let train = PulseTrain::at_rate(PulseType::Wide, 333.0).unwrap();
    ArmFor { train, arm: arm() }
}

#[test]
fn a_run_is_whole_and_hello_has_its_timing() {
    for (asked, timing) in [
        (usual(), (20_000, 2_000, 500)),
        (digital(), (15_020, 1_502, 699)),
        (narrow(), (17_860, 1_786, 300)),
    ] {
        let mut bench = Bench::new();
        let mut client = bench.armed_for(asked).unwrap();
        let hello = *client.hello().unwrap();
        let stated = (hello.frame_us, hello.sample_us, hello.first_sample_us);
        assert_eq!(stated, timing);
        client.run(run(15), bench.now);
        let events = bench.wait(&mut client);
        require_whole_run(&events);
        assert!(bench.are_true(&events));
        // A later host finds that timing, and arms for what it wants.
        bench.connect().unwrap();
    }
}

#[test]
fn the_other_type_of_pulses_is_refused_with_what_to_do() {
    let mut bench = Bench::new();
    bench.armed_for(narrow()).unwrap();
    let Err(refused) = bench.armed_for(usual()) else {
        panic!("a wide pulse for a narrow-pulse servo");
    };
    let refusal = Refusal::OtherPulseType;
    let request = "arm";
    assert_eq!(refused, ClientError::Refused { request, refusal });
    assert!(refused.to_string().contains("reset button"), "{refused}");
}

/// A rig that arms and goes on with its own timing is disarmed: the times in its recording would be wrong.
#[test]
fn a_rig_that_makes_other_pulses_than_it_was_armed_for_is_let_go() {
    let mut bench = Bench::new();
    bench.alters = |message| match message {
        RigMessage::Hello(mut hello) => {
            (hello.frame_us, hello.sample_us) = (20_000, 2_000);
            RigMessage::Hello(hello)
        }
        other => other,
    };
    let mut client = bench.connect().unwrap();
    client.arm(digital(), bench.now);
    let events = bench.wait(&mut client);
    match events.as_slice() {
        [
            Event::Failed(ClientError::TimingDiffers { field, .. }),
            Event::Answered(_),
        ] => {
            assert_eq!(*field, "frame_us");
        }
        other => panic!("{other:?}"),
    }
    assert!(!bench.has_pulses());
}
