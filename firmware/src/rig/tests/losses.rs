//! Frames that the board does not catch.

use super::*;

#[test]
fn frames_lost_on_the_board_leave_a_hole_and_shift_nothing() {
    let mut bench = Bench::running(short_run(1));
    bench.frames(3);
    bench.lose(2);
    // Frame 5: 1450 was due; the board held the last pulse that was set.
    bench.frames(20);
    let frames = bench.sent_frames();
    let indices: Vec<u16> = frames.iter().map(|f| f.index).collect();
    assert_eq!(indices, [0, 1, 2, 5, 6, 7, 8, 9, 10]);
    // The reference went on meanwhile: 6 and later are as if nothing had happened.
    assert_eq!(bench.sent_pulses()[4..], SHORT_RUN_US[6..]);
    let ended = bench.only_end();
    assert_eq!((ended.frames, ended.frames_lost_on_board), (11, 2));
    assert_eq!(ended.check, check_of(&frames));
    assert_eq!(bench.status().frames_lost_on_board, 2);
}

#[test]
fn losing_the_end_of_a_run_still_ends_it() {
    let mut bench = Bench::running(short_run(1));
    bench.frames(9);
    bench.lose(100_000);
    bench.frame();
    let ended = bench.only_end();
    assert_eq!(
        (ended.reason, ended.frames, ended.frames_lost_on_board),
        (EndReason::Complete, 11, 2)
    );
    assert_eq!(bench.on_line, Some(NEUTRAL));
}

#[test]
fn the_boards_frame_number_may_wrap_during_a_run() {
    let mut bench = Bench::new();
    bench.number = u32::MAX - 6;
    bench.frame();
    bench.request(Command::Hello);
    bench.request(Command::Arm(arm()));
    bench.request(Command::Start(short_run(1)));
    bench.frames(20);
    assert_eq!(bench.sent_pulses(), SHORT_RUN_US);
    assert_eq!(bench.status().frames_lost_on_board, 0);
}
