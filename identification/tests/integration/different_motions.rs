//! Servos that were asked for different motions: which of them are called different, and which withhold a verdict.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use servoid_identification::comparison::{
    Comparison, ComparisonOptions, Verdict, compare, compare_models,
};
use servoid_identification::results::{Check, Reason};
use servoid_identification::{Options, Record, identify};

use servoid_test_support::servos::{Limit, Linear, PERIOD, limited, measured, staircase};

#[test]
#[ignore = "many seeds: cargo test -p servoid-identification --test integration -- --ignored different_motions"]
fn one_servo_under_two_references_is_not_called_two_servos() {
    let under = |size: f64, limit: f64, seed: u64| {
        let input: Vec<f64> = staircase().iter().map(|u| size * u).collect();
        let clean = limited(0.7, 60.0, Limit::Rate(limit, limit), &input, input[0]);
        Record::of_run(PERIOD, input, measured(&clean, 1.0, seed)).unwrap()
    };
    let options = ComparisonOptions {
        input_unit: "deg".to_owned(),
        ..ComparisonOptions::default()
    };
    let (small, large) = (under(1.0, 150.0, 1), under(6.0, 150.0, 2));
    let found = compare(&small, &large, &options).unwrap();
    assert_eq!(found.verdict, Verdict::Undecided, "{}", found.summary);
    let said = |found: &Comparison| {
        let mut advice = found.advice.iter();
        let found = advice.find(|advice| advice.check == Check::References);
        found.map(|advice| advice.finding.clone())
    };
    let words = said(&found).unwrap();
    assert!(
        words.contains("from -5 to +5 deg") && words.contains("from -30 to +30 deg"),
        "{words}"
    );
    // One that looks linear under each of two strokes is slower over the larger one, and different from itself.
    let (short, long) = (under(0.8, 200.0, 6), under(1.2, 200.0, 7));
    let found = compare(&short, &long, &options).unwrap();
    assert_eq!(found.verdict, Verdict::Undecided, "{}", found.summary);
    assert!(found.descriptions_of_different_motions);
    let apart = found.bounds.valid().unwrap().difference_percent;
    assert!(apart.at_least > found.margin_percent, "{apart:?}");
    let reason = "Not decided by the step responses: the strokes differ, ±4 against ±6 deg.";
    assert!(found.summary.starts_with(reason), "{}", found.summary);
    // A linear servo answers both alike.
    let linear = compare(&under(1.0, 1e6, 3), &under(6.0, 1e6, 4), &options).unwrap();
    assert_eq!(linear.verdict, Verdict::Same, "{}", linear.summary);
    assert!(said(&linear).is_some() && !linear.descriptions_of_different_motions);
    // The same reference is not worth a word.
    assert_eq!(
        said(&compare(&small, &under(1.0, 150.0, 5), &options).unwrap()),
        None
    );
}

/// Steps within ±5 that are held for 0.2 to 0.4 s: to anywhere, or to one of nine levels.
fn random_levels(seed: u64, of_nine: bool) -> Vec<f64> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut input = Vec::new();
    while input.len() < 4000 {
        let level = match of_nine {
            true => 1.25 * f64::from(random.random_range(-4..=4)),
            false => random.random_range(-5.0..5.0),
        };
        input.extend(std::iter::repeat_n(level, random.random_range(100..200)));
    }
    input.truncate(4000);
    input
}

/// Pairs of other draws, of which some have 16 levels or less and some more, and ends that differ by a tenth.
#[test]
fn the_draw_of_random_levels_withholds_no_verdict() {
    let verdicts = |pairs: u64, gain: f64| -> Vec<Comparison> {
        let compared = (0..pairs).into_par_iter().map(|pair| {
            let side = |seed: u64, gain: f64| {
                let servo = Linear::second_order(gain, 0.0255, 0.6, 60.0);
                let input = random_levels(seed, pair % 2 == 0);
                let clean = servo.respond(&input, input[0], 0.0);
                Record::of_run(PERIOD, input, measured(&clean, 1.0, seed)).unwrap()
            };
            let (a, b) = (side(2 * pair, 1.0), side(2 * pair + 1, gain));
            compare(&a, &b, &ComparisonOptions::default()).unwrap()
        });
        compared.collect()
    };
    for found in verdicts(4, 0.92) {
        assert_eq!(found.verdict, Verdict::Different, "{}", found.summary);
    }
    for found in verdicts(4, -1.0) {
        assert_eq!(found.verdict, Verdict::Different, "{}", found.summary);
        assert!(found.turns_the_other_way, "{}", found.summary);
    }
    for found in verdicts(8, 1.0) {
        assert_ne!(found.verdict, Verdict::Different, "{}", found.summary);
    }
}

/// Only models of servos that look linear, both under strokes of several sizes or both under those of one, are called different.
#[test]
fn models_under_unlike_references_are_not_called_different() {
    let of = |gain: f64, size: f64, seed: u64| {
        let servo = Linear::second_order(gain, 0.0255, 0.6, 60.0);
        let input: Vec<f64> = staircase().iter().map(|u| size * u).collect();
        let clean = servo.respond(&input, input[0], 0.0);
        let record = Record::of_run(PERIOD, input, measured(&clean, 1.0, seed)).unwrap();
        identify(&record, &Options::default()).unwrap()
    };
    let (a, b) = (of(1.0, 1.0, 1), of(0.9, 2.0, 2));
    let under = |strokes: [Option<f64>; 2]| {
        let options = ComparisonOptions {
            strokes_of_models: strokes,
            ..ComparisonOptions::default()
        };
        compare_models(&a, &b, &options).unwrap()
    };
    for strokes in [[None; 2], [Some(10.0); 2]] {
        assert_eq!(under(strokes).verdict, Verdict::Different);
    }
    for strokes in [
        [Some(10.0), None],
        [None, Some(20.0)],
        [Some(10.0), Some(20.0)],
    ] {
        let found = under(strokes);
        assert_eq!(found.verdict, Verdict::Undecided, "{}", found.summary);
        assert!(found.descriptions_of_different_motions, "{}", found.summary);
    }
}

/// What a caller knows of the records leaves no bounds, whatever they show by themselves.
#[test]
fn a_fault_that_the_caller_states_leaves_no_bounds() {
    let input = random_levels(3, true);
    let clean = Linear::second_order(1.0, 0.0255, 0.6, 60.0).respond(&input, input[0], 0.0);
    let side = |seed: u64| Record::of_run(PERIOD, &input, measured(&clean, 1.0, seed)).unwrap();
    let options = ComparisonOptions {
        withheld: [Some(Reason::CommandsBetweenRows); 2],
        ..ComparisonOptions::default()
    };
    let found = compare(&side(1), &side(2), &options).unwrap();
    assert_eq!(found.bounds.withdrawn(), Some(Reason::CommandsBetweenRows));
    assert!(!found.has_verdict() && found.verdict == Verdict::Undecided);
    let intervals = found.differences.iter().map(|row| row.lower);
    assert!(intervals.flatten().next().is_none());
}

/// That of the models of two records, for which nobody states the strokes.
fn verdict_of_models(a: &Record, b: &Record) -> Comparison {
    let [a, b] = [a, b].map(|side| identify(side, &Options::default()).unwrap());
    compare_models(&a, &b, &ComparisonOptions::default()).unwrap()
}

/// Limits from such as nobody notices to such as every stroke meets, up and down or one way, and strokes that are up to twice as large.
#[test]
fn a_servo_that_is_limited_is_not_different_from_itself_under_another_draw() {
    (0..40u64).into_par_iter().for_each(|pair| {
        let limit = 60.0 * 1.06f64.powi(pair as i32);
        let limit = match pair % 4 {
            0 => Limit::Rate(limit, 1e6),
            1 => Limit::Play(0.02 * pair as f64),
            _ => Limit::Rate(limit, limit),
        };
        let side = |seed: u64, size: f64| {
            let input = random_levels(seed, pair % 3 == 0);
            let input: Vec<f64> = input.iter().map(|u| size * u).collect();
            let clean = limited(0.7, 60.0, limit, &input, input[0]);
            Record::of_run(PERIOD, input, measured(&clean, 1.0, seed)).unwrap()
        };
        let size = 1.0 + (pair % 5) as f64 / 5.0;
        let (a, b) = (side(2 * pair, 1.0), side(2 * pair + 1, size));
        let of_models = (pair % 4 == 3).then(|| verdict_of_models(&a, &b));
        let of_records = compare(&a, &b, &ComparisonOptions::default()).unwrap();
        for found in of_models.into_iter().chain([of_records]) {
            let words = &found.summary;
            assert_ne!(found.verdict, Verdict::Different, "{pair}: {words}");
        }
    });
}
