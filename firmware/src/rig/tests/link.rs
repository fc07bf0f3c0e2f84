//! What waits until the link takes it.

use super::*;

#[test]
fn a_message_waits_until_the_link_takes_it() {
    let mut bench = Bench::running(short_run(1));
    bench.frames(20);
    bench.sent.clear();
    bench.rig.on_request(&Request {
        session: 1,
        id: bench.id.wrapping_add(1),
        command: Command::KeepAlive,
    });
    let mut offered = Vec::new();
    for _ in 0..3 {
        bench.rig.send(|message| {
            offered.push(*message);
            false
        });
    }
    assert!(matches!(
        offered[..],
        [a, b, c] if a == b && b == c && matches!(a, RigMessage::Reply { .. })
    ));
    bench.flush();
    bench.flush();
    assert_eq!(bench.sent, offered[..1]);
}

#[test]
fn answers_come_before_resends_before_live_frames_before_the_end() {
    let mut bench = Bench::running(short_run(1));
    bench.frames(3);
    bench.sent.clear();
    // The link takes nothing while the run goes on to its end.
    bench.frames_unsent(8);
    bench.request(Command::Resend {
        run: 1,
        first: 1,
        count: 2,
    });
    let kinds: Vec<String> = bench
        .sent
        .iter()
        .map(|message| match message {
            RigMessage::Reply { .. } => "reply".into(),
            RigMessage::Ended(_) => "ended".into(),
            RigMessage::Frame(frame) => frame.index.to_string(),
            other => format!("{other:?}"),
        })
        .collect();
    assert_eq!(
        kinds,
        [
            "reply", "1", "2", "3", "4", "5", "6", "7", "8", "9", "10", "ended"
        ]
    );
    assert_eq!(bench.status().backlog_high_water, 8);
}

#[test]
fn a_silent_link_loses_nothing_for_as_long_as_the_history_is() {
    let long = Start {
        post_roll_frames: 1_000,
        ..short_run(1)
    };
    let mut bench = Bench::running(long);
    bench.frames_unsent(frame_history::CAPACITY);
    bench.flush();
    assert_eq!(bench.sent_frames().len(), frame_history::CAPACITY);
    bench.frames_unsent(frame_history::CAPACITY + 1);
    bench.sent.clear();
    bench.flush();
    // One too many: the oldest is gone, and what is sent says so by its index.
    assert_eq!(bench.sent_frames().len(), frame_history::CAPACITY);
    assert_eq!(
        usize::from(bench.sent_frames()[0].index),
        frame_history::CAPACITY + 1
    );
}

#[test]
fn resend_passes_over_what_is_not_there() {
    let mut bench = Bench::running(short_run(1));
    bench.frames(3);
    bench.lose(1);
    bench.frames(20);
    let original = bench.sent_frames();
    bench.sent.clear();
    let resend = |run, first, count| Command::Resend { run, first, count };
    assert_eq!(bench.refused(resend(2, 0, 1)), Refusal::UnknownRun);
    assert_eq!(
        bench.request(resend(1, 2, 3)),
        Some(Outcome::Done),
        "frame 3 was lost on the board"
    );
    assert_eq!(bench.sent_frames(), original[2..4]);
    bench.sent.clear();
    bench.request(resend(1, 9, u16::MAX));
    bench.request(resend(1, u16::MAX, u16::MAX));
    assert_eq!(bench.sent_frames(), original[8..]);
    // The same id again sends nothing again.
    bench.sent.clear();
    bench.raw_request(1, bench.id, resend(1, 0, 5));
    assert_eq!(bench.sent_frames(), []);
}

#[test]
fn a_flood_of_requests_keeps_the_newest_answers() {
    let mut bench = Bench::connected();
    for _ in 0..100 {
        bench.id += 1;
        bench.rig.on_request(&Request {
            session: 1,
            id: bench.id,
            command: Command::KeepAlive,
        });
    }
    bench.flush();
    assert!(matches!(
        bench.sent.last(),
        Some(RigMessage::Reply { id, .. }) if *id == bench.id
    ));
    assert!(bench.sent.len() < 100);
}

#[test]
fn who_has_no_session_is_answered_when_all_else_is_said_and_once() {
    let mut bench = Bench::running(short_run(1));
    bench.frames_unsent(3);
    for id in 0..100 {
        for command in [Command::Disarm, Command::Hello] {
            bench.rig.on_request(&Request {
                session: 2,
                id,
                command,
            });
        }
    }
    bench.flush();
    let [frames @ .., visitor] = &bench.sent[..] else {
        panic!("nothing was sent");
    };
    assert!(matches!(visitor, RigMessage::Hello(_)), "{visitor:?}");
    assert_eq!(frames.len(), 3);
    assert!(frames.iter().all(|m| matches!(m, RigMessage::Frame(_))));
}
