//! Runs on a good line, and what becomes of them when one thing goes wrong.

use crate::bench::{Bench, frames, ms, run};
use servoid_client::{Arrived, ClientError, Event, RunEnding};
use servoid_protocol::message::{Command, EndReason, RigMessage};

fn ended(reason: EndReason, arrived: Arrived) -> Event {
    Event::RunEnded(RunEnding { reason, arrived })
}

#[test]
fn a_run_begins_comes_frame_by_frame_and_ends_whole() {
    let mut bench = Bench::new();
    let mut client = bench.armed().unwrap();
    client.run(run(15), bench.now);
    let events = bench.wait(&mut client);
    assert_eq!(events.first(), Some(&Event::RunBegun { run: 0x5151 }));
    assert_eq!(
        events.last(),
        Some(&ended(EndReason::Complete, Arrived::Whole))
    );
    assert_eq!((frames(&events).len(), events.len()), (50, 52));
    assert!(bench.are_true(&events));
    assert_eq!(client.frames_asked_again(), 0);
}

#[test]
fn a_number_that_the_last_run_had_is_changed() {
    let mut bench = Bench::new();
    let mut client = bench.armed().unwrap();
    for number in [0x5151, 0x5152, 0x5151] {
        client.run(run(5), bench.now);
        let events = bench.wait(&mut client);
        assert_eq!(events.first(), Some(&Event::RunBegun { run: number }));
        assert_eq!(frames(&events).len(), 40);
    }
}

#[test]
fn a_run_that_is_stopped_is_whole_as_far_as_it_goes() {
    let mut bench = Bench::new();
    let mut client = bench.armed().unwrap();
    client.run(run(500), bench.now);
    let mut events = bench.wait_until(&mut client, ms(500));
    client.stop_run(bench.now);
    events.extend(bench.wait(&mut client));
    assert_eq!(
        events.last(),
        Some(&ended(EndReason::Stopped, Arrived::Whole))
    );
    assert!((20..30).contains(&frames(&events).len()));
    assert_eq!(bench.count(|c| matches!(c, Command::Stop { .. })), 1);
}

#[test]
fn an_end_that_is_lost_is_asked_for() {
    let mut bench = Bench::new();
    bench.drops = |message| matches!(message, RigMessage::Ended(_));
    let mut client = bench.armed().unwrap();
    client.run(run(5), bench.now);
    let events = bench.wait(&mut client);
    assert_eq!(
        events.last(),
        Some(&ended(EndReason::Complete, Arrived::Whole))
    );
    // The last frame, and the quiet behind it.
    let asked = bench.sent.last().unwrap().0;
    assert!(asked < ms(41 * 20 + 300), "{asked:?}");
}

#[test]
fn a_rig_that_is_kept_alive_does_not_end_a_long_run() {
    let mut bench = Bench::new();
    let mut client = bench.armed().unwrap();
    client.run(run(1_000), bench.now);
    let events = bench.wait(&mut client);
    assert_eq!(
        events.last(),
        Some(&ended(EndReason::Complete, Arrived::Whole))
    );
    // 20.7 s, twice a second.
    assert!((39..=42).contains(&bench.count(|c| matches!(c, Command::Status))));
}

#[test]
fn a_host_that_sleeps_beyond_its_lease_finds_what_came_before() {
    let mut bench = Bench::new();
    let mut client = bench.armed().unwrap();
    bench.host_sleeps = ms(500)..ms(3_500);
    client.run(run(500), bench.now);
    let events = bench.wait(&mut client);
    assert_eq!(
        events.last(),
        Some(&ended(EndReason::LeaseLapsed, Arrived::Whole))
    );
    assert!(bench.are_true(&events));
    // From the last sign of life on the lease is 100 frames.
    assert!((99..=125).contains(&frames(&events).len()));
}

#[test]
fn frames_that_a_cut_line_costs_are_fetched() {
    let mut bench = Bench::new();
    let mut client = bench.armed().unwrap();
    bench.to_host.cut = ms(400)..ms(1_600);
    client.run(run(100), bench.now);
    let events = bench.wait(&mut client);
    assert_eq!(
        events.last(),
        Some(&ended(EndReason::Complete, Arrived::Whole))
    );
    assert!(bench.are_true(&events) && frames(&events).len() == 135);
    assert!(
        (58..=64).contains(&client.frames_asked_again()),
        "{}",
        client.frames_asked_again()
    );
}

#[test]
fn frames_that_the_board_has_forgotten_are_given_up() {
    let mut bench = Bench::new();
    let mut client = bench.armed().unwrap();
    // Longer than the board's memory of 256 frames, and shorter than a host's patience.
    bench.to_host.cut = ms(400)..ms(7_400);
    client.run(run(600), bench.now);
    let events = bench.wait(&mut client);
    assert_eq!(
        events.last(),
        Some(&ended(EndReason::Complete, Arrived::LostOnLine))
    );
    let frames = frames(&events);
    let lost = 635 - frames.len();
    assert!(
        bench.are_true(&events) && (90..=110).contains(&lost),
        "{lost}"
    );
}

#[test]
fn a_rig_that_is_reset_is_noticed_and_asked_to_stop() {
    let mut bench = Bench::new();
    let mut client = bench.armed().unwrap();
    bench.reset_at = Some(ms(600));
    client.run(run(15), bench.now);
    let events = bench.wait(&mut client);
    assert!(events.contains(&Event::Failed(ClientError::RunForgotten)));
    assert!(bench.are_true(&events) && frames(&events).len() >= 20);
    assert!(bench.count(|c| matches!(c, Command::Stop { .. })) >= 1);
    let pulses = bench.log.iter().skip(31).filter(|f| f.pulse.is_some());
    assert_eq!(pulses.count(), 0);
}

#[test]
fn a_line_that_stays_cut_ends_after_ten_seconds_with_what_came() {
    let mut bench = Bench::new();
    let mut client = bench.armed().unwrap();
    bench.to_host.cut = ms(600)..ms(1_000_000);
    client.run(run(15), bench.now);
    let events = bench.wait_until(&mut client, ms(10_650));
    assert_eq!(
        events.last(),
        Some(&Event::Failed(ClientError::FellSilent { seconds: 10 }))
    );
    assert!(frames(&events).len() >= 20);
    // The rig has been asked to stop until nobody has answered for long enough.
    bench.wait(&mut client);
    assert_eq!(bench.count(|c| matches!(c, Command::Stop { .. })), 11);
}

#[test]
fn a_rig_that_answers_and_sends_no_frame_ends_after_twenty_seconds() {
    let mut bench = Bench::new();
    bench.drops = |message| matches!(message, RigMessage::Frame(_));
    let mut client = bench.armed().unwrap();
    client.run(run(1_100), bench.now);
    let events = bench.wait(&mut client);
    let stood_still = Event::Failed(ClientError::NoFrames { seconds: 20 });
    assert!(events.contains(&stood_still), "{events:?}");
}

#[test]
fn a_run_that_is_let_go_gives_what_waits_behind_a_gap() {
    let mut bench = Bench::new();
    bench.drops = |message| matches!(message, RigMessage::Frame(frame) if frame.index == 10);
    let mut client = bench.armed().unwrap();
    client.run(run(100), bench.now);
    let before = bench.wait_until(&mut client, ms(600));
    assert_eq!(frames(&before).last().map(|frame| frame.index), Some(9));
    client.break_off_run(bench.now);
    let mut events = before;
    events.extend(bench.wait(&mut client));
    let indices: Vec<u16> = frames(&events).iter().map(|frame| frame.index).collect();
    assert!(indices[10] == 11 && indices.len() > 20, "{indices:?}");
    assert!(bench.are_true(&events));
    assert_eq!(
        bench.sent.last().unwrap().1.command,
        Command::Stop { run: 0x5151 }
    );
}
