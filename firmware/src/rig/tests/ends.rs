//! How runs end.

use super::*;

#[test]
fn stop_ends_the_run_it_names_and_no_other() {
    let mut bench = Bench::running(short_run(3));
    bench.frames(3);
    assert_eq!(bench.refused(Command::Stop { run: 2 }), Refusal::UnknownRun);
    assert_eq!(bench.request(Command::Stop { run: 3 }), Some(Outcome::Done));
    bench.frame();
    assert_eq!(bench.on_line, Some(NEUTRAL));
    assert_eq!(
        bench.request(Command::Stop { run: 3 }),
        Some(Outcome::Done),
        "already so"
    );
    bench.frames(20);
    let ended = bench.only_end();
    assert_eq!((ended.reason, ended.frames), (EndReason::Stopped, 3));
    assert_eq!(ended.check, check_of(&bench.sent_frames()));
    assert_eq!(bench.on_line, Some(NEUTRAL));
}

#[test]
fn disarm_ends_a_run_and_the_pulses() {
    let mut bench = Bench::running(short_run(3));
    bench.frames(3);
    assert_eq!(bench.request(Command::Disarm), Some(Outcome::Done));
    bench.frame();
    assert_eq!(bench.on_line, None);
    assert_eq!(bench.only_end().reason, EndReason::Disarmed);
    assert_eq!(bench.status().activity, Activity::Idle);
    // What was recorded can still be asked for.
    bench.sent.clear();
    bench.request(Command::Resend {
        run: 3,
        first: 0,
        count: 9,
    });
    assert_eq!(bench.sent_pulses(), SHORT_RUN_US[..3]);
}

#[test]
fn a_lease_that_lapses_ends_the_run_within_two_frames() {
    let mut bench = Bench::armed();
    bench.request(Command::Arm(Arm {
        lease_frames: 5,
        ..arm()
    }));
    bench.request(Command::Start(short_run(1)));
    let mut frames = 0;
    while bench.ends().is_empty() {
        bench.frame();
        frames += 1;
    }
    assert_eq!(frames, 5);
    assert_eq!(bench.on_line, Some(NEUTRAL));
    assert_eq!(bench.only_end().reason, EndReason::LeaseLapsed);
    bench.frames(50);
    assert_eq!(bench.on_line, Some(NEUTRAL), "and stays there");
}

#[test]
fn a_lease_counts_lost_frames_as_well() {
    let mut bench = Bench::armed();
    bench.request(Command::Arm(Arm {
        lease_frames: 5,
        ..arm()
    }));
    bench.request(Command::Start(short_run(1)));
    bench.frame();
    bench.lose(3);
    bench.frame();
    assert_eq!(bench.only_end().reason, EndReason::LeaseLapsed);
}

#[test]
fn every_request_of_the_session_renews_the_lease_and_no_other_does() {
    let long = Start {
        post_roll_frames: 1_000,
        ..short_run(1)
    };
    let lasts = |ask: fn(&mut Bench)| {
        let mut bench = Bench::armed();
        bench.request(Command::Arm(Arm {
            lease_frames: 5,
            ..arm()
        }));
        bench.request(Command::Start(long));
        (0..20).all(|_| {
            bench.frames(4);
            ask(&mut bench);
            bench.ends().is_empty()
        })
    };
    let renewing: [fn(&mut Bench); 5] = [
        |b| {
            b.request(Command::KeepAlive);
        },
        |b| {
            b.request(Command::Status);
        },
        |b| {
            b.request(Command::Stop { run: 99 });
        },
        |b| {
            b.request(Command::Hello);
        },
        |b| {
            b.raw_request(1, b.id, Command::KeepAlive);
        },
    ];
    for (n, ask) in renewing.into_iter().enumerate() {
        assert!(lasts(ask), "renewing {n}");
    }
    let useless: [fn(&mut Bench); 3] = [
        |_| (),
        |b| {
            b.raw_request(2, 1, Command::KeepAlive);
        },
        |b| {
            b.raw_request(1, b.id.wrapping_sub(1), Command::KeepAlive);
        },
    ];
    for (n, ask) in useless.into_iter().enumerate() {
        assert!(!lasts(ask), "useless {n}");
    }
}

/// The readings of such a frame are wrong, and still within their healthy range.
#[test]
fn a_low_supply_ends_the_run_and_keeps_the_next_from_beginning() {
    let mut bench = Bench::running(short_run(1));
    bench.frame();
    bench.supply.is_low = true;
    bench.frame();
    let ended = bench.only_end();
    assert_eq!((ended.reason, ended.frames), (EndReason::SupplyLow, 2));
    assert_eq!(bench.on_line, Some(NEUTRAL));
    let start = Command::Start(short_run(2));
    assert_eq!(bench.refused(start), Refusal::SupplyLow);
    assert_eq!(bench.refused(Command::Arm(arm())), Refusal::SupplyLow);
    bench.supply.is_low = false;
    bench.frame();
    assert_eq!(bench.request(start), Some(Outcome::Done));
}

#[test]
fn five_sick_samples_in_a_row_end_the_run_and_four_do_not() {
    let (mut tail, mut head, mut four) = (HEALTHY, HEALTHY, HEALTHY);
    tail[8..].fill(SICK);
    head[..3].fill(SICK);
    four[3..7].fill(Counts(15_001));
    let mut bench = Bench::running(short_run(1));
    bench.frame_with(bench.on_line, four);
    bench.frame_with(bench.on_line, tail);
    assert_eq!(bench.ends(), []);
    // Two at the end of one frame and three at the start of the next.
    bench.frame_with(bench.on_line, head);
    let ended = bench.only_end();
    assert_eq!(
        (ended.reason, ended.frames),
        (EndReason::SensorOutOfRange, 3)
    );
    assert_eq!(bench.on_line, Some(NEUTRAL));
}
