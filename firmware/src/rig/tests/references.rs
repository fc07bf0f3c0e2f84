//! Every reference: played as the shared code says, within the limits, and ended on demand.

use super::*;
use servoid_protocol::reference::{MAX_TONES, Multisine, Prbs, Stairs, Step, Steps, Sweep};

/// One of each, to `amplitude_us` on both sides.
fn references(amplitude_us: u16) -> [Reference; 6] {
    let multisine = Multisine {
        amplitude_us,
        tone_64ths_us: 0,
        period_frames: 2 * MAX_TONES + 2,
        first: 1,
        spacing: 1,
        tones: MAX_TONES,
        periods: 1,
    };
    let far = amplitude_us as i16;
    let steps = [far, -far, 0].map(|offset_us| Step {
        offset_us,
        hold_frames: 3,
    });
    [
        Reference::Staircase(Staircase {
            amplitude_us,
            longest_hold_frames: 6,
            shortest_hold_frames: 2,
            hold_step_frames: 2,
        }),
        Reference::Stairs(Stairs {
            amplitude_us,
            levels: 4,
            hold_frames: 2,
            cycles: 1,
        }),
        Reference::Prbs(Prbs {
            amplitude_us,
            register: 5,
            seed: 1,
            chip_frames: 1,
            chips: 31,
        }),
        Reference::Sweep(Sweep {
            amplitude_us,
            first_millihertz: 500,
            last_millihertz: 10_000,
            frames: 40,
        }),
        Reference::Multisine(multisine.with_largest_tones()),
        Reference::Steps(Steps::new(2, &steps).unwrap()),
    ]
}

/// The limits of [`arm`] are this far from neutral (µs).
const ROOM_US: u16 = 100;

fn run_of(reference: Reference) -> Start {
    Start {
        reference,
        ..short_run(1)
    }
}

#[test]
fn each_is_played_as_the_shared_code_says_and_stays_within_the_limits() {
    for reference in references(ROOM_US) {
        let start = run_of(reference);
        let mut bench = Bench::running(start);
        bench.frames_alive(start.frames() as usize);
        let expected = (0..start.frames()).map(|index| {
            let offset = start.offset_us(index).unwrap();
            NEUTRAL.offset_by(offset).unwrap().0
        });
        let played = bench.sent_pulses();
        assert!(played.iter().copied().eq(expected), "{}", reference.name());
        assert!(played.iter().all(|pulse| (1_400..=1_600).contains(pulse)));
        assert_eq!(bench.only_end().reason, EndReason::Complete);
        assert_eq!(bench.on_line, Some(NEUTRAL));
    }
}

#[test]
fn each_is_refused_one_microsecond_beyond_the_limits() {
    for reference in references(ROOM_US + 1) {
        let mut bench = Bench::armed();
        let refusal = bench.refused(Command::Start(run_of(reference)));
        assert_eq!(refusal, Refusal::BeyondLimits, "{}", reference.name());
        bench.frames(3);
        assert_eq!(bench.on_line, Some(NEUTRAL));
    }
}

#[test]
fn each_ends_at_neutral_wherever_it_is_stopped() {
    for reference in references(ROOM_US) {
        let start = run_of(reference);
        for frames in 0..start.frames() as usize {
            let mut bench = Bench::running(start);
            bench.frames_alive(frames);
            assert_eq!(bench.request(Command::Stop { run: 1 }), Some(Outcome::Done));
            bench.frames(2);
            assert_eq!(bench.on_line, Some(NEUTRAL), "{}", reference.name());
            let end = bench.only_end();
            assert_eq!(end.reason, EndReason::Stopped);
            assert_eq!(usize::from(end.frames), frames);
            assert_eq!(end.check, check_of(&bench.sent_frames()));
        }
    }
}

/// A frame that the board did not catch shifts nothing: the reference is a function of the frame's
/// number.
#[test]
fn each_goes_on_in_its_place_after_lost_frames() {
    for reference in references(ROOM_US) {
        let start = run_of(reference);
        let mut bench = Bench::running(start);
        bench.frames(7);
        bench.lose(4);
        bench.frames(start.frames() as usize - 11);
        assert_eq!(bench.only_end().frames_lost_on_board, 4);
        // The first frame after the gap still has the pulse that was asked for before it.
        for frame in bench.sent_frames().iter().filter(|f| f.index != 11) {
            let offset = start.offset_us(frame.index.into()).unwrap();
            assert_eq!(
                Some(frame.pulse),
                NEUTRAL.offset_by(offset),
                "{} {}",
                reference.name(),
                frame.index
            );
        }
    }
}

#[test]
fn a_reference_that_makes_no_sense_is_refused() {
    let mut bench = Bench::armed();
    for reference in [
        Reference::Stairs(Stairs {
            amplitude_us: 50,
            levels: 1,
            hold_frames: 2,
            cycles: 1,
        }),
        Reference::Prbs(Prbs {
            amplitude_us: 50,
            register: 5,
            seed: 32,
            chip_frames: 1,
            chips: 31,
        }),
        Reference::Sweep(Sweep {
            amplitude_us: 50,
            first_millihertz: 0,
            last_millihertz: 25_001,
            frames: 40,
        }),
        Reference::Steps(Steps::new(1, &[]).unwrap()),
    ] {
        let refusal = bench.refused(Command::Start(run_of(reference)));
        assert_eq!(refusal, Refusal::BadReference, "{reference:?}");
    }
}
