//! Connecting: a rig that is there, that is not, that another host has.

use crate::bench::{Bench, FRAME, arm, ms, run, usual};
use servoid_client::{Answer, ClientError, Event};
use servoid_protocol::PulseTrain;
use servoid_protocol::lease::{LEASE, LONGEST_LEASE_S};
use servoid_protocol::message::{Command, RigMessage};

#[test]
fn a_rig_on_a_good_line_is_connected_within_two_answers() {
    let mut bench = Bench::new();
    let client = bench.connect().unwrap();
    assert!(bench.now <= ms(8), "{:?}", bench.now);
    assert_eq!(client.hello().unwrap().board.as_str(), "bench");
    assert_eq!(client.next_deadline(), None);
}

#[test]
fn a_request_without_an_answer_is_repeated_eleven_times_a_quarter_of_a_second_apart() {
    let mut bench = Bench::new();
    let mut client = bench.connect().unwrap();
    bench.drops = |message| matches!(message, RigMessage::Reply { .. });
    let begin = bench.now;
    client.request(Command::KeepAlive, begin);
    let events = bench.wait(&mut client);
    let request = "prolong the lease";
    assert_eq!(events, [Event::Failed(ClientError::NoAnswer { request })]);
    assert_eq!(bench.now, begin + 11 * ms(250));
    let ids = bench.sent.iter().map(|(_, request)| request.id);
    assert_eq!(ids.filter(|id| *id == 2).count(), 11);
}

#[test]
fn a_port_with_nobody_behind_it_is_silent_and_one_with_something_else_is_not() {
    let mut bench = Bench::new();
    bench.drops = |_| true;
    let nobody = bench.connect().err();
    assert_eq!(nobody, Some(ClientError::NobodyThere { bytes: 0 }));
    assert_eq!(bench.now, 12 * ms(250));
    bench.to_host.send(&[1, 2, 3, 0], bench.now);
    let nobody = bench.connect().err();
    assert_eq!(nobody, Some(ClientError::NobodyThere { bytes: 4 }));
}

#[test]
fn a_rig_that_another_host_holds_is_had_when_the_lease_is_over() {
    let mut bench = Bench::new();
    let mut first = bench.armed().unwrap();
    first.run(run(1_000), bench.now);
    bench.wait_until(&mut first, ms(100));
    let abandoned = bench.now;
    bench.connect_as(2, false).unwrap();
    let waited = bench.now - abandoned;
    // It asks ten times a second, and the answers take a few milliseconds.
    assert!(
        LEASE - ms(100) - FRAME < waited && waited < LEASE + ms(150),
        "{waited:?}"
    );
}

#[test]
fn a_rig_whose_host_goes_on_is_not_had() {
    let mut bench = Bench::new();
    bench.armed().unwrap();
    // As if the first host kept it alive: a lease that is longer than any patience.
    let long = servoid_protocol::message::Arm {
        lease_frames: PulseTrain::USUAL.frames_in(LONGEST_LEASE_S),
        ..arm()
    };
    bench.other_host(1, 100, Command::Arm(long));
    let refused = bench.connect_as(2, false).err();
    assert_eq!(refused, Some(ClientError::RunOfAnother));
}

#[test]
fn a_number_that_an_older_session_has_is_changed() {
    let mut bench = Bench::new();
    bench.connect().unwrap();
    let mut again = bench.connect_as(1, false).unwrap();
    let number = bench.sent.last().unwrap().1.session;
    assert_eq!(number, 2);
    again.request(Command::KeepAlive, bench.now);
    assert_eq!(bench.wait(&mut again), [Event::Answered(Answer::Done)]);
}

#[test]
fn nothing_is_sent_while_a_run_of_another_program_is_heard() {
    let mut bench = Bench::new();
    let mut first = bench.armed().unwrap();
    first.run(run(20), bench.now);
    bench.wait_until(&mut first, ms(300));
    let (sent, begin) = (bench.sent.len(), bench.now);
    // The run ends after 55 frames, 15 of which have been; its host says no more.
    bench.connect_as(2, true).unwrap();
    let first_sent = bench.sent[sent].0 - begin;
    assert!(
        ms(800) < first_sent && first_sent < ms(1_100),
        "{first_sent:?}"
    );
}

#[test]
fn a_run_of_another_program_that_goes_on_is_left_alone() {
    let mut bench = Bench::new();
    bench.armed().unwrap();
    let long = servoid_protocol::message::Arm {
        lease_frames: PulseTrain::USUAL.frames_in(LONGEST_LEASE_S),
        ..arm()
    };
    bench.other_host(1, 100, Command::Arm(long));
    bench.other_host(1, 101, Command::Start(run(1_000)));
    let sent = bench.sent.len();
    let refused = bench.connect_as(2, true).err();
    assert_eq!(refused, Some(ClientError::RunOfAnother));
    assert_eq!(bench.sent.len(), sent, "not a byte");
}

#[test]
fn a_rig_of_other_messages_is_known_and_not_armed() {
    let mut bench = Bench::new();
    bench.armed().unwrap();
    // The rig's hello, with another schema.
    let mut hello = *bench.connect_as(5, false).unwrap().hello().unwrap();
    hello.schema_hash ^= 1;
    let connect = servoid_client::Connect {
        session: 9,
        attempts: 3,
        listens_first: false,
    };
    let mut client = servoid_client::Client::connect(&connect, bench.now);
    let mut buffer = [0; servoid_protocol::framing::MAX_WIRE];
    let wire = servoid_protocol::framing::encode(&RigMessage::Hello(hello), &mut buffer).unwrap();
    client.handle(wire, bench.now);
    assert_eq!(client.poll_event(), Some(Event::Connected(hello)));
    while client.poll_transmit().is_some() {}
    client.arm(usual(), bench.now);
    let refused = client.poll_event();
    assert!(matches!(
        refused,
        Some(Event::Failed(ClientError::SchemaDiffers { .. }))
    ));
    assert_eq!(client.poll_transmit(), None);
}
