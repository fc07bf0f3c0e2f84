//! Sessions and answers.

use super::*;

#[test]
fn hello_says_who_the_rig_is() {
    let mut bench = Bench::new();
    bench.raw_request(9, 1, Command::Hello);
    let [RigMessage::Hello(hello)] = bench.sent[..] else {
        panic!("{:?}", bench.sent);
    };
    assert_eq!(hello.schema_hash, SCHEMA_HASH);
    assert_eq!(hello.board, identity().board);
    assert_eq!(hello.build.as_str(), env!("CARGO_PKG_VERSION"));
    assert_eq!((hello.frame_us, hello.sample_us), (20_000, 2_000));
    assert_eq!(
        (hello.shortest_pulse_us, hello.longest_pulse_us),
        (800, 2_200)
    );
    assert_eq!(usize::from(hello.history_frames), frame_history::CAPACITY);
}

const UNKNOWN: Option<Outcome> = Some(Outcome::Refused(Refusal::UnknownSession));

#[test]
fn a_stranger_is_refused_and_an_idle_rig_is_taken_over() {
    let mut bench = Bench::connected();
    assert_eq!(bench.raw_request(2, 1, Command::Disarm), UNKNOWN);
    bench.raw_request(2, 2, Command::Hello);
    assert_eq!(
        bench.raw_request(2, 3, Command::Arm(arm())),
        Some(Outcome::Done)
    );
    assert_eq!(bench.request(Command::KeepAlive), UNKNOWN);
}

/// A `Hello` of session 2 is answered, and whether it has opened that session.
fn visit(bench: &mut Bench, id: u16) -> bool {
    bench.sent.clear();
    bench.raw_request(2, id, Command::Hello);
    assert!(matches!(bench.sent[..], [RigMessage::Hello(_)]));
    bench.raw_request(2, id + 1, Command::KeepAlive) == Some(Outcome::Done)
}

#[test]
fn a_hello_of_another_session_takes_no_rig_that_is_in_use() {
    let mut bench = Bench::armed();
    assert!(!visit(&mut bench, 1), "armed");
    assert_eq!(
        bench.request(Command::Start(short_run(1))),
        Some(Outcome::Done)
    );
    for id in 0..20 {
        bench.frame();
        assert!(!visit(&mut bench, 10 + 2 * id), "running, then ended");
    }
    assert!(matches!(bench.status().activity, Activity::Ended(_)));
    // Its frames are still there for the session that made them.
    let resend = Command::Resend {
        run: 1,
        first: 0,
        count: 11,
    };
    bench.sent.clear();
    assert_eq!(bench.request(resend), Some(Outcome::Done));
    assert_eq!(bench.sent_pulses(), SHORT_RUN_US);
}

#[test]
fn a_visitor_is_no_sign_of_life_and_has_the_rig_when_the_lease_is_over() {
    for run in [None, Some(1)] {
        let mut bench = Bench::armed();
        let long = |run| Start {
            post_roll_frames: 2 * LEASE,
            ..short_run(run)
        };
        let last = run.map_or(Command::KeepAlive, |run| Command::Start(long(run)));
        assert_eq!(bench.request(last), Some(Outcome::Done));
        for id in 0..LEASE {
            assert!(!visit(&mut bench, 2 * id), "after {id} frames, {run:?}");
            bench.frame();
        }
        assert!(visit(&mut bench, 2 * LEASE), "{run:?}");
        assert_eq!(bench.request(Command::KeepAlive), UNKNOWN);
        assert_eq!(bench.on_line, Some(NEUTRAL));
    }
}

#[test]
fn a_rig_that_was_disarmed_is_anybodys() {
    let mut bench = Bench::armed();
    assert_eq!(bench.request(Command::Disarm), Some(Outcome::Done));
    assert!(visit(&mut bench, 1));
}

#[test]
fn a_repeated_request_has_no_second_effect_and_the_same_outcome() {
    let mut bench = Bench::armed();
    bench.request(Command::Start(short_run(1)));
    let id = bench.id;
    bench.frames(4);
    let before = bench.status();
    // A copy of the start, but `Status` is the newest request now.
    assert_eq!(
        bench.raw_request(1, id, Command::Start(short_run(1))),
        Some(Outcome::Refused(Refusal::Outdated))
    );
    assert_eq!(
        bench.refused(Command::Start(short_run(2))),
        Refusal::Running
    );
    bench.frames(20);
    // The same id again: the same answer, though the rig is not running any more.
    assert_eq!(
        bench.raw_request(1, bench.id, Command::Start(short_run(2))),
        Some(Outcome::Refused(Refusal::Running))
    );
    assert!(matches!(
        before.activity,
        Activity::Running { run: 1, frames: 3 }
    ));
    assert_eq!(bench.sent_pulses(), SHORT_RUN_US);
}

#[test]
fn a_repeated_start_does_not_start_again() {
    let mut bench = Bench::armed();
    bench.request(Command::Start(short_run(1)));
    for _ in 0..30 {
        bench.frame();
        let again = bench.raw_request(1, bench.id, Command::Start(short_run(1)));
        assert_eq!(again, Some(Outcome::Done));
    }
    assert_eq!(bench.sent_pulses(), SHORT_RUN_US);
    assert_eq!(bench.only_end().reason, EndReason::Complete);
}

#[test]
fn the_unused_command_is_a_reject() {
    let mut bench = Bench::connected();
    assert_eq!(bench.request(Command::Unused), None);
    assert_eq!(bench.status().rejects, 1);
    bench.rig.count_rejects(2);
    assert_eq!(bench.status().rejects, 3);
}
