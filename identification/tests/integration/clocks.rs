//! Records whose times are not what they are taken for have no bounds, and a reason.

use rand::RngExt;
use rand_distr::StandardNormal;
use servoid_identification::results::{Model, Reason};
use servoid_identification::{Options, Record, identify};
use servoid_test_support::plants::random;

/// Steps of the simulation in a sample.
const STEPS: usize = 20;
const SAMPLES: usize = 6000;
const PERIOD_S: f64 = 0.002;

/// A servo of second order under random levels, whose position is read by a clock that goes faster by the share `drift`, every `refresh`
/// samples; its stiffness falls by the share `weaker` along the record.
fn model(seed: u64, drift: f64, refresh: usize, weaker: f64) -> Model {
    let mut random = random(seed);
    let mut input = Vec::new();
    while input.len() < SAMPLES {
        let level = random.random_range(-10.0..10.0);
        input.extend(vec![level; random.random_range(50..200)]);
    }
    input.truncate(SAMPLES);
    let (mut position, mut speed) = (0.0, 0.0);
    let step_s = PERIOD_S / STEPS as f64;
    let course: Vec<f64> = (0..(SAMPLES * STEPS) * 21 / 20)
        .map(|step| {
            let now = step / STEPS;
            let command = input[now.saturating_sub(6).min(SAMPLES - 1)];
            let stiffness = 1600.0 * (1.0 - weaker * now as f64 / SAMPLES as f64);
            speed += step_s * (stiffness * (command - position) - 64.0 * speed);
            position += step_s * speed;
            position
        })
        .collect();
    let mut reading = 0.0;
    let output: Vec<f64> = (0..SAMPLES)
        .map(|k| {
            if k % refresh == 0 {
                let at = (k as f64 * (1.0 + drift) * STEPS as f64).round() as usize;
                reading = course[at] + 0.05 * random.sample::<f64, _>(StandardNormal);
            }
            reading
        })
        .collect();
    identify(
        &Record::of_run(PERIOD_S, input, output).unwrap(),
        &Options::default(),
    )
    .unwrap()
}

#[test]
fn clocks_that_differ_and_sensors_that_are_slow_take_the_level() {
    for seed in 1..4 {
        let clean = model(seed, 0.0, 1, 0.0);
        assert!(clean.bounds.valid().is_some(), "{seed}");
        // 2 to 12 ms over 12 s.
        for drift in [0.0002, -0.0005, 0.001] {
            let found = model(seed, drift, 1, 0.0);
            assert_eq!(
                found.bounds.withdrawn(),
                Some(Reason::LagDrift),
                "{seed}, {drift}"
            );
        }
        let slow = model(seed, 0.0, 5, 0.0);
        assert_eq!(slow.bounds.withdrawn(), Some(Reason::HeldOutput), "{seed}");
        let weaker = model(seed, 0.0, 1, 0.3);
        assert_eq!(weaker.bounds.withdrawn(), Some(Reason::LagDrift), "{seed}");
    }
}
