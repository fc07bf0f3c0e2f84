//! A rig begins nothing for a host that it has not heard of late.

use crate::bench::{Bench, arm, ms, require_whole_run, run, usual};
use servoid_client::{Answer, ClientError, Event};
use servoid_protocol::lease::LEASE;
use servoid_protocol::message::{Command, Outcome, RigMessage};

#[test]
fn a_host_that_was_silent_gives_a_sign_of_life_and_goes_on() {
    let mut bench = Bench::new();
    let mut client = bench.connect().unwrap();
    bench.pass(2 * LEASE);
    client.arm(usual(), bench.now);
    assert_eq!(bench.wait(&mut client), [Event::Answered(Answer::Done)]);
    bench.pass(2 * LEASE);
    client.run(run(15), bench.now);
    let events = bench.wait(&mut client);
    require_whole_run(&events);
}

/// The host says `Start`, dies, and the line delivers it eight seconds later.
#[test]
fn what_a_dead_host_said_moves_nothing() {
    let mut bench = Bench::new();
    bench.armed().unwrap();
    bench.pass(ms(8_000));
    bench.other_host(1, 3, Command::Start(run(15)));
    let begin = bench.log.len();
    bench.pass(ms(2_000));
    let neutral = Some(arm().neutral);
    assert!(
        bench.log[begin..]
            .iter()
            .all(|frame| frame.pulse == neutral)
    );
}

/// The rig has armed, and nothing that it says arrives.
#[test]
fn a_failed_arming_is_followed_by_a_disarming() {
    let mut bench = Bench::new();
    let mut client = bench.connect().unwrap();
    bench.drops = |message| {
        let done = Outcome::Done;
        matches!(message, RigMessage::Reply { outcome, .. } if *outcome == done)
    };
    client.arm(usual(), bench.now);
    let events = bench.wait(&mut client);
    let request = "arm";
    assert_eq!(
        events.first(),
        Some(&Event::Failed(ClientError::NoAnswer { request }))
    );
    assert_eq!(events.len(), 2, "and how the disarming went: {events:?}");
    bench.pass(ms(40));
    assert!(!bench.has_pulses());
}
