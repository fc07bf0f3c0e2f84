//! The stable prior: bands are narrower and hold, and where it does not apply, it is left out and said to be. The table "The stable
//! prior" of docs/method.md has more runs of more lines.

use servoid_identification::diagnostics::PriorOutcome;
use servoid_identification::{Options, Prior, Record, identify_explained};
use servoid_test_support::coverage::{Case, Reference, measure};
use servoid_test_support::hard_lines::{HardLine, Hardship, hard_lines};
use servoid_test_support::plants::{Noise, PERIOD, Plant, low_passed, random, simulate, staircase};

/// Saves most of the time; the servos here settle well within it.
fn options(prior: Prior) -> Options {
    Options {
        longest_settling: Some(201),
        prior,
        ..Options::default()
    }
}

#[test]
fn bands_under_the_prior_are_narrower_and_hold() {
    require_narrower_and_held(&[(Plant::A, Noise::White, 0.6)]);
}

#[test]
#[ignore = "three seconds: cargo test -p servoid-identification --test integration -- --ignored prior"]
fn bands_under_the_prior_are_narrower_and_hold_for_another_servo_and_in_slow_noise() {
    require_narrower_and_held(&[(Plant::C, Noise::White, 0.5), (Plant::A, Noise::Ar2, 1.0)]);
}

/// For servos in noise: their bands are narrower than this share of those without the prior.
fn require_narrower_and_held(cases: &[(Plant, Noise, f64)]) {
    const RUNS: usize = 5;
    let mut whole = 0.0;
    for &(plant, noise, narrower) in cases {
        let case = Case {
            reference: Reference::Staircase,
            plant,
            noise,
            scale: 1.0,
        };
        let [free, found] =
            [Prior::None, Prior::Stable].map(|prior| measure(case, RUNS, &options(prior)));
        assert_eq!(found.claimed, 1.0, "{found}");
        assert!(
            found.half_widths.1 < narrower * free.half_widths.1,
            "{found}\n{free}"
        );
        whole += found.whole * RUNS as f64;
    }
    // Of 10 curves at 98 %, two outside happen once in 60 times, of 5 once in 260.
    let all = (cases.len() * RUNS) as f64;
    assert!(whole >= all - 1.0, "{whole} of {all} curves inside");
}

/// Without the second kernel, most of such curves are outside.
#[test]
fn a_slow_end_is_in_the_band_or_takes_the_level() {
    let slow = |line: &&HardLine| matches!(line.hardship, Hardship::SlowEnd { .. });
    let lines = hard_lines();
    let line = lines.iter().find(slow).unwrap();
    let options = Options {
        prior: Prior::Stable,
        ..Options::default()
    };
    let found = line.measure(3, &options);
    assert!(found.claimed == 0.0 || found.whole == 1.0, "{found}");
}

#[test]
fn what_became_of_the_prior_is_said() {
    let outcome = |input: &[f64], prior| {
        let output = simulate(Plant::A, Noise::White, input, 1.0, &mut random(8));
        let record = Record::of_run(PERIOD, input, output).unwrap();
        let found = identify_explained(&record, &options(prior)).unwrap();
        found.explanation.prior
    };
    assert_eq!(outcome(&staircase(), Prior::None), None);
    let Some(PriorOutcome::Used {
        time_constants_s,
        contradiction,
    }) = outcome(&staircase(), Prior::Stable)
    else {
        panic!("it is used");
    };
    assert!(contradiction < 4.0);
    // The envelope of the response, 1/(60 rad/s * 0.5), and the kernel's decay is that of its square.
    assert!(
        time_constants_s.iter().any(|t| (0.005..0.1).contains(t)),
        "{time_constants_s:?}"
    );
    let slow_noise = simulate(Plant::A, Noise::Ar1, &staircase(), 1.0, &mut random(8));
    let record = Record::of_run(PERIOD, staircase(), slow_noise).unwrap();
    let found = identify_explained(&record, &options(Prior::Stable)).unwrap();
    let said = found.explanation.prior.as_ref().unwrap().in_words();
    assert!(said.contains("a slow end"), "{said}");
    let without = identify_explained(&record, &options(Prior::None)).unwrap();
    assert_eq!(found.model.step, without.model.step);
    let smooth = low_passed(&low_passed(&staircase(), 20.0), 20.0);
    assert_eq!(
        outcome(&smooth, Prior::Stable),
        Some(PriorOutcome::NotApplicable)
    );
}
