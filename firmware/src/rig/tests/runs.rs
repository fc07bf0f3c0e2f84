//! A run, frame by frame.

use super::*;

#[test]
fn a_run_is_what_was_asked_for_frame_by_frame() {
    let mut bench = Bench::running(short_run(5));
    bench.frames(15);
    let frames = bench.sent_frames();
    assert_eq!(bench.sent_pulses(), SHORT_RUN_US);
    assert!(
        frames
            .iter()
            .enumerate()
            .all(|(i, f)| f.run == 5 && usize::from(f.index) == i)
    );
    let ended = Ended {
        run: 5,
        reason: EndReason::Complete,
        frames: 11,
        frames_lost_on_board: 0,
        check: check_of(&frames),
    };
    assert_eq!(bench.only_end(), ended);
    assert_eq!(bench.on_line, Some(NEUTRAL));
    assert_eq!(bench.status().activity, Activity::Ended(ended));
}

#[test]
fn frame_0_is_the_first_with_the_first_pulse_on_the_line() {
    let start = Start {
        pre_roll_frames: 0,
        ..short_run(1)
    };
    let mut bench = Bench::armed();
    bench.request(Command::Start(start));
    // The frame under way still has neutral on the line: it is not part of the run.
    bench.frame();
    assert_eq!(bench.sent_pulses(), []);
    bench.frames(20);
    assert_eq!(bench.sent_pulses(), SHORT_RUN_US[2..]);
}

#[test]
fn a_first_pulse_that_came_too_late_is_asked_for_again() {
    let start = Start {
        pre_roll_frames: 0,
        ..short_run(1)
    };
    let mut bench = Bench::running(start);
    bench.frame_with(Some(NEUTRAL), HEALTHY);
    assert_eq!(bench.on_line, Some(PulseWidth(1_550)));
    bench.frames(20);
    assert_eq!(bench.sent_pulses(), SHORT_RUN_US[2..]);
}

#[test]
fn what_is_recorded_is_the_pulse_that_was_applied() {
    let mut bench = Bench::running(short_run(1));
    bench.frames(2);
    // The board missed the edge: the pulse before stayed for one more frame.
    bench.frame_with(Some(NEUTRAL), HEALTHY);
    bench.frames(20);
    let mut expected = SHORT_RUN_US;
    expected[2] = 1_500;
    assert_eq!(bench.sent_pulses(), expected);
}

#[test]
fn a_frame_without_a_pulse_is_no_frame_of_a_run() {
    for none in [None, Some(PulseWidth(0))] {
        let mut bench = Bench::running(short_run(1));
        bench.frames(4);
        bench.frame_with(none, HEALTHY);
        bench.frames(20);
        assert_eq!(bench.sent_frames().len(), 10);
        assert_eq!(bench.only_end().frames_lost_on_board, 1);
    }
}

#[test]
fn a_run_is_refused_for_each_reason() {
    let mut bench = Bench::armed();
    let with_amplitude = |amplitude_us| Start {
        reference: Reference::Staircase(Staircase {
            amplitude_us,
            ..Staircase::PAPER
        }),
        ..short_run(1)
    };
    assert_eq!(
        bench.refused(Command::Start(with_amplitude(101))),
        Refusal::BeyondLimits
    );
    assert_eq!(
        bench.refused(Command::Start(with_amplitude(0))),
        Refusal::BadReference
    );
    let mut samples = HEALTHY;
    samples[9] = SICK;
    bench.frame_with(bench.on_line, samples);
    assert_eq!(
        bench.refused(Command::Start(short_run(1))),
        Refusal::SensorOutOfRange
    );
    bench.frame();
    bench.request(Command::Start(short_run(1)));
    assert_eq!(
        bench.refused(Command::Start(short_run(2))),
        Refusal::Running
    );
    bench.frames(20);
    assert_eq!(
        bench.refused(Command::Start(short_run(1))),
        Refusal::RunRepeated
    );
    bench.sent.clear();
    assert_eq!(
        bench.request(Command::Start(short_run(2))),
        Some(Outcome::Done)
    );
    bench.frames(20);
    assert_eq!(bench.sent_pulses(), SHORT_RUN_US);
}
