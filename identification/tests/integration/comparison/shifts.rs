//! A shift in time is called all of a difference where it is, and nowhere else.

use super::{options, plain, record, servo};
use servoid_identification::comparison::{ComparisonOptions, Verdict, compare};
use servoid_test_support::servos::Linear;

const ALL: &str = "Apart from that shift in time these recordings show no difference.";

/// What is said of a servo beside the first one, for a few draws of the noise.
fn said(other: &Linear) -> Vec<String> {
    let of = |seed: u64| {
        let found = compare(&plain(&servo(), seed), &plain(other, seed + 50), &options()).unwrap();
        found.summary
    };
    (1..6).map(of).collect()
}

#[test]
fn a_later_servo_is_only_later() {
    for delay_s in [0.0275, 0.0315, 0.0215] {
        let said = said(&Linear::second_order(0.97, delay_s, 0.5, 60.0));
        let all = said.iter().filter(|said| said.contains(ALL)).count();
        assert!(all > 3, "{delay_s}: {said:?}");
    }
}

#[test]
fn another_gain_speed_or_damping_is_no_shift() {
    let others = [
        ("gain", Linear::second_order(0.85, 0.0255, 0.5, 60.0)),
        (
            "a little of the gain",
            Linear::second_order(0.94, 0.0255, 0.5, 60.0),
        ),
        (
            "gain and delay",
            Linear::second_order(0.9, 0.0315, 0.5, 60.0),
        ),
        ("slower", Linear::second_order(0.97, 0.0255, 0.5, 51.0)),
        (
            "a little slower",
            Linear::second_order(0.97, 0.0255, 0.5, 57.0),
        ),
        (
            "slower and later",
            Linear::second_order(0.97, 0.0315, 0.5, 51.0),
        ),
        ("damping", Linear::second_order(0.97, 0.0255, 0.7, 60.0)),
        ("nothing", servo()),
    ];
    for (what, other) in others {
        let said = said(&other);
        assert!(
            said.iter().all(|said| !said.contains(ALL)),
            "{what}: {said:?}"
        );
        assert!(
            !said
                .iter()
                .any(|said| said.contains("neither") && said.contains("not all")),
            "{what}: {said:?}"
        );
    }
    let slower = said(&Linear::second_order(0.97, 0.0255, 0.5, 51.0));
    let is_said = |said: &&String| {
        said.contains("That is not all: behind the shift that brings them closest")
    };
    assert!(slower.iter().filter(is_said).count() > 3, "{slower:?}");
}

/// Runs that scatter in gain and delay.
#[test]
fn three_runs_of_another_gain_are_no_shift() {
    let weaker = Linear::second_order(0.97 * 0.88, 0.0255, 0.5, 60.0);
    for seed in [1, 11, 21] {
        let a = record(&servo(), &servo(), 0.0, seed..seed + 3, 1.0);
        let b = record(&weaker, &weaker, 0.0, seed + 30..seed + 33, 1.0);
        let found = compare(&a, &b, &options()).unwrap();
        assert!(!found.summary.contains(ALL), "{}", found.summary);
    }
}

#[test]
fn a_difference_that_waits_of_either_recording_may_make_is_left_open() {
    let with_waits = |other: &Linear, waits_s: [f64; 2]| {
        let options = ComparisonOptions {
            waits_s,
            ..options()
        };
        let found = compare(&plain(&servo(), 1), &plain(other, 51), &options).unwrap();
        (found.verdict, found.may_be_waits)
    };
    let later = Linear::second_order(0.97, 0.0355, 0.5, 60.0);
    let slower = Linear::second_order(0.97, 0.0255, 0.5, 48.0);
    let weaker = Linear::second_order(0.85, 0.0355, 0.5, 60.0);
    let (open, different) = ((Verdict::Undecided, true), (Verdict::Different, false));
    // 10 ms: by the wait of the second one alone, as it is the later one.
    assert_eq!(with_waits(&later, [0.0, 0.02]), open);
    assert_eq!(with_waits(&later, [0.02, 0.0]), different);
    assert_eq!(with_waits(&later, [0.0, 0.005]), different);
    assert_eq!(with_waits(&later, [0.0; 2]), different);
    // No wait makes a servo slower, or go less far.
    assert_eq!(with_waits(&slower, [0.02; 2]), different);
    assert_eq!(with_waits(&weaker, [0.02; 2]), different);
    assert_eq!(
        with_waits(&servo(), [0.02; 2]),
        (Verdict::Same, false),
        "alike"
    );
}
