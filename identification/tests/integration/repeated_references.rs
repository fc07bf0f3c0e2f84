//! Several runs of one reference: what a servo that is not linear does differently after each command, it does in each run.

use rand::RngExt;
use servoid_dynamics::{Grid, ServoParameters, Start, simulate};
use servoid_identification::results::Model;
use servoid_identification::{Options, Record, Run, identify};

use servoid_test_support::plants::{normal, random};
use servoid_test_support::servos::{Limit, limited_in_steps};

/// Of the noise \[degrees\].
const SD: f64 = 0.06;

/// A servo of 60 rad/s that is 10 ms late and no faster than 250 degrees a second, in samples of 10 ms.
fn with_limited_speed(input: &[f64]) -> Vec<f64> {
    let limit = Limit::Rate(250.0, 250.0);
    limited_in_steps(0.9, 60.0, limit, input, input[0], (2e-4, 50, 50))
}

/// A servo of 50 rad/s that does not drive within `dead_band` degrees of its target, in samples of 5 ms.
fn with_dead_band(dead_band: f64, input: &[f64]) -> Vec<f64> {
    let servo = ServoParameters {
        delay_s: 0.007,
        gain: 1.06,
        dead_band: Some(dead_band),
        ..ServoParameters::linear(2500.0, 85.0)
    };
    let (grid, start) = (
        Grid::new(0.005, 0.0, 1e-4),
        Start::at_rest(input[0], Some(input[0])),
    );
    let mut output = Vec::new();
    simulate(&servo, &grid, &start, input, |_, y| output.push(y));
    output
}

/// So many runs of `input`, answered by `clean`, each with noise of its own.
fn identified(input: &[f64], clean: &[f64], (count, period_s): (usize, f64), seed: u64) -> Model {
    let mut random = random(seed);
    let mut run = || {
        let output: Vec<f64> = clean.iter().map(|y| y + SD * normal(&mut random)).collect();
        Run::new(input.to_vec(), output).unwrap()
    };
    let runs = (0..count).map(|_| run()).collect();
    let record = Record::new(period_s, runs).unwrap();
    identify(&record, &Options::default()).unwrap()
}

/// Of nine runs, N was longer, and in other recordings the longest that is looked at, which left no bounds.
#[test]
fn runs_of_one_reference_are_no_evidence_of_a_longer_response_than_one_of_them() {
    for seed in [21, 22, 23] {
        let mut random = random(seed);
        let mut input = vec![0.0; 80];
        while input.len() < 2400 {
            let level = f64::from(random.random_range(-30..=30));
            input.extend(std::iter::repeat_n(level, random.random_range(35..100)));
        }
        let clean = with_limited_speed(&input);
        let one = identified(&input, &clean, (1, 0.01), seed);
        let nine = identified(&input, &clean, (9, 0.01), seed);
        assert!(!one.linear && !nine.linear, "{seed}");
        assert!(
            nine.bounds.valid().is_some(),
            "{seed}: {:?}",
            nine.bounds.withdrawn()
        );
        assert_eq!(
            nine.structure.settling_samples, one.structure.settling_samples,
            "{seed}"
        );
        let asks_for_other_orders = |model: &Model| {
            let said = model.advice.iter().find(|said| said.is_of_linearity());
            said.unwrap().remedy.contains("levels in another order")
        };
        assert!(!asks_for_other_orders(&one) && asks_for_other_orders(&nine));
    }
}

/// A dead band leaves the servo short of each level, as a smaller gain would: that gain grew at each turn of fit and levels, until the response had none that is known.
#[test]
fn a_gain_is_that_of_the_response_where_levels_are_off() {
    let levels = [0.0, 10.0, 20.0, 10.0, 0.0, -10.0, -20.0, -10.0];
    for (seed, count) in [(31, 6), (33, 6), (37, 3)] {
        let mut random = random(seed);
        let mut input = vec![0.0; 160];
        for level in levels.into_iter().cycle() {
            let hold = if random.random_bool(0.5) { 100 } else { 140 };
            input.extend(std::iter::repeat_n(level, hold));
            if input.len() >= 4800 {
                break;
            }
        }
        let model = identified(&input, &with_dead_band(0.52, &input), (count, 0.005), 32);
        let gain = model.metrics.dc_gain.value;
        assert!(
            gain.is_some_and(|gain| (1.0..1.1).contains(&gain)),
            "{seed}: {gain:?}"
        );
    }
}
