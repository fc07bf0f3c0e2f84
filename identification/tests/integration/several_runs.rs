//! Several runs of a linear servo, with zeros of their own or samples missing: neither passes for something of the servo.

use rand::RngExt;
use servoid_identification::results::Check;
use servoid_identification::{Options, Record, Run, identify};
use servoid_test_support::plants::{Noise, PERIOD, Plant, random, simulate};

/// Four runs of random levels, whose zeros are off by up to `zeros`, and of whose outputs the share `missing` is missing.
fn record(plant: Plant, zeros: f64, missing: f64, seed: u64) -> Record<'static> {
    let mut random = random(seed);
    let runs = [1300, 1500, 1700, 2000].map(|samples| {
        let mut input = vec![0.0; 50];
        while input.len() < samples {
            let hold = random.random_range(15..100);
            input.extend(vec![random.random_range(-8.0..8.0); hold]);
        }
        input.truncate(samples);
        let zero = random.random_range(0.0..=zeros);
        let mut output = simulate(plant, Noise::White, &input, 0.05, &mut random);
        for y in &mut output {
            let is_missing = random.random_bool(missing);
            *y = if is_missing { f64::NAN } else { *y + zero };
        }
        Run::new(input, output).unwrap()
    });
    Record::new(PERIOD, runs.to_vec()).unwrap()
}

fn withdrawn(
    plant: Plant,
    zeros: f64,
    missing: f64,
    seeds: std::ops::Range<u64>,
) -> Vec<(u64, String)> {
    seeds
        .filter_map(|seed| {
            let model =
                identify(&record(plant, zeros, missing, seed), &Options::default()).unwrap();
            let reason = model.bounds.withdrawn()?;
            Some((seed, format!("{reason:?}")))
        })
        .collect()
}

/// Beside errors of rows that no fit uses, commands to come explained the output of three of these (seeds 10, 13 and 17).
#[test]
fn missing_samples_make_no_feedback() {
    let found = withdrawn(Plant::A, 0.0, 0.1, 10..18);
    assert_eq!(found, []);
}

/// Of one of these (seed 49) a response four times as long as the servo's stood for the zeros: a run has few parts of that length to show them.
#[test]
fn zeros_of_runs_make_no_late_response() {
    let found = withdrawn(Plant::B, 0.2, 0.0, 46..52);
    assert_eq!(found, []);
}

/// White noise beside gains that differ by 1 % (standard deviation of these four: 0.9 %).
#[test]
fn runs_whose_gains_differ_have_no_slow_noise() {
    for seed in 0..4 {
        let whole = record(Plant::A, 0.0, 0.0, seed);
        let gains = [0.99, 1.005, 1.012, 0.995];
        let of_own_gain = |(run, gain): (&Run<'static>, f64)| {
            let output: Vec<f64> = run.output().iter().map(|y| gain * y).collect();
            Run::new(run.input().to_vec(), output).unwrap()
        };
        let runs = whole.runs().iter().zip(gains).map(of_own_gain);
        let model = identify(
            &Record::new(PERIOD, runs.collect()).unwrap(),
            &Options::default(),
        )
        .unwrap();
        let says = |check: Check| model.advice.iter().find(|advice| advice.check == check);
        assert!(
            says(Check::RunScatter).is_some(),
            "seed {seed}: {:?}",
            model.advice
        );
        assert_eq!(says(Check::SlowNoise), None, "seed {seed}");
        let of_whiteness = says(Check::Whiteness).unwrap();
        let of_runs = of_whiteness.remedy.contains("identify one run alone");
        assert!(of_runs, "seed {seed}: {of_whiteness:?}");
    }
}
