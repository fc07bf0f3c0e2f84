//! Requests that a line delivers when their host may be gone.

use super::*;
use servoid_protocol::lease::LEASE_FRAMES;

/// A line holds back all that a host said last, and delivers it after so many frames.
fn held_back(bench: &mut Bench, frames: u16, command: Command) -> Option<Outcome> {
    let (before, last) = (bench.id, bench.id.wrapping_add(1));
    bench.frames(usize::from(frames));
    // A copy of the request before is what a host sends that waits for its answer.
    bench.raw_request(1, before, Command::KeepAlive);
    let outcome = bench.raw_request(1, last, command);
    bench.id = last;
    bench.frames(3);
    outcome
}

const LAPSED: Option<Outcome> = Some(Outcome::Refused(Refusal::LeaseLapsed));

#[test]
fn a_start_that_comes_late_starts_nothing() {
    let mut bench = Bench::armed();
    bench.request(Command::KeepAlive);
    let start = Command::Start(short_run(1));
    assert_eq!(held_back(&mut bench, 8 * 50, start), LAPSED);
    bench.frames(20);
    assert_eq!(bench.sent_frames(), []);
    // Its copies start nothing either, and are no signs of life.
    assert_eq!(bench.raw_request(1, bench.id, start), LAPSED);
    assert_eq!(bench.request(start), LAPSED);
    // Whoever is alive says so, and may start.
    assert_eq!(bench.request(Command::KeepAlive), Some(Outcome::Done));
    assert_eq!(bench.request(start), Some(Outcome::Done));
}

#[test]
fn an_arming_that_comes_late_leaves_the_pulses_off() {
    let mut bench = Bench::connected();
    bench.request(Command::KeepAlive);
    assert_eq!(held_back(&mut bench, 8 * 50, Command::Arm(arm())), LAPSED);
    assert_eq!(bench.on_line, None);
    assert_eq!(bench.request(Command::KeepAlive), Some(Outcome::Done));
    assert_eq!(bench.request(Command::Arm(arm())), Some(Outcome::Done));
}

#[test]
fn a_request_that_comes_in_time_is_carried_out_and_a_frame_later_is_not() {
    for (frames, expected) in [
        (LEASE_FRAMES - 1, Some(Outcome::Done)),
        (LEASE_FRAMES, LAPSED),
    ] {
        let mut bench = Bench::connected();
        bench.request(Command::KeepAlive);
        let outcome = held_back(&mut bench, frames, Command::Arm(arm()));
        assert_eq!(outcome, expected, "arming after {frames} frames");
        let mut bench = Bench::armed();
        bench.request(Command::KeepAlive);
        let outcome = held_back(&mut bench, frames, Command::Start(short_run(1)));
        assert_eq!(outcome, expected, "starting after {frames} frames");
    }
}

/// The lease of the arming is shorter than what is allowed at the most.
#[test]
fn nothing_starts_under_a_lease_that_has_lapsed() {
    let mut bench = Bench::armed();
    bench.request(Command::Arm(Arm {
        lease_frames: 5,
        ..arm()
    }));
    bench.frames(5);
    assert_eq!(
        bench.refused(Command::Start(short_run(1))),
        Refusal::LeaseLapsed
    );
}

/// No host, the longest lease and the widest range of the sensor: what moves then, moves for five seconds.
#[test]
fn the_longest_run_without_a_host_ends_with_the_longest_lease() {
    let widest = Arm {
        longest: PulseWidth(2_200),
        sensor_low: Counts(0),
        sensor_high: Counts(16_380),
        ..arm()
    };
    let mut bench = Bench::connected();
    let forever = Arm {
        lease_frames: LEASE + 1,
        ..widest
    };
    assert_eq!(bench.refused(Command::Arm(forever)), Refusal::BadLimits);
    let longest = Arm {
        lease_frames: LEASE,
        ..widest
    };
    assert_eq!(bench.request(Command::Arm(longest)), Some(Outcome::Done));
    let hours = Start {
        post_roll_frames: u16::MAX - 100,
        ..short_run(1)
    };
    assert_eq!(bench.request(Command::Start(hours)), Some(Outcome::Done));
    bench.frames(usize::from(LEASE));
    assert_eq!(bench.only_end().reason, EndReason::LeaseLapsed);
    assert_eq!(LEASE, 250, "5 s");
}

/// A sensor whose wire is off or shorted reads at a rail, whatever range its host calls healthy.
#[test]
fn a_reading_at_a_rail_is_healthy_for_nobody() {
    let everything = Arm {
        sensor_low: Counts(0),
        sensor_high: Counts(16_380),
        ..arm()
    };
    for rail in [0, 63, 16_380 - 63, 16_380] {
        let mut bench = Bench::connected();
        bench.frame_with(None, [Counts(rail); 10]);
        assert_eq!(
            bench.refused(Command::Arm(everything)),
            Refusal::SensorOutOfRange,
            "{rail}"
        );
        bench.frame();
        bench.request(Command::Arm(everything));
        bench.request(Command::Start(short_run(1)));
        bench.frame();
        bench.frame_with(bench.on_line, [Counts(rail); 10]);
        assert_eq!(bench.only_end().reason, EndReason::SensorOutOfRange);
    }
    for inside in [64, 16_380 - 64] {
        let mut bench = Bench::connected();
        bench.frame_with(None, [Counts(inside); 10]);
        assert_eq!(bench.request(Command::Arm(everything)), Some(Outcome::Done));
    }
}
