//! Runs that begin at rest, but elsewhere than where the servo comes to rest later under the same command.

use rand::RngExt;
use servoid_identification::results::Check;
use servoid_identification::{Identification, Options, Record, Run, identify_explained};

use servoid_test_support::plants::{Noise, random};
use servoid_test_support::servos::{Limit, PERIOD, limited};

/// One of the two levels, where runs begin, and the stroke to the other one \[degrees\].
const FIRST: f64 = -5.0;
const STROKE: f64 = 10.0;

/// Holds of 0.15 to 0.8 s at both levels, one after the other, for 10 s.
fn two_levels(seed: u64) -> Vec<f64> {
    let mut random = random(seed);
    let mut input = vec![FIRST; 200];
    while input.len() < 5000 {
        let level = 2.0 * FIRST + STROKE - input.last().unwrap();
        input.extend(std::iter::repeat_n(level, random.random_range(75..400)));
    }
    input.truncate(5000);
    input
}

/// Four runs of one reference, answered by a servo of 40 rad/s without overshoot, with play of this `width`, from rest in the middle of that.
fn identified(width: f64, seed: u64, noise: Noise) -> Identification {
    let input = two_levels(seed);
    let clean = limited(1.0, 40.0, Limit::Play(width), &input, FIRST);
    let mut random = random(seed + 1000);
    let mut run = || {
        let noise = noise.samples(&mut random, clean.len());
        let output: Vec<f64> = clean.iter().zip(noise).map(|(y, v)| y + v).collect();
        (Run::new(input.clone(), output).unwrap()).with_input_at_rest(FIRST)
    };
    let record = Record::new(PERIOD, (0..4).map(|_| run()).collect()).unwrap();
    identify_explained(&record, &Options::default()).unwrap()
}

fn begins_elsewhere(found: &Identification) -> bool {
    found.explanation.start.is_some()
}

/// A response that goes on for 1.2 s described them, with a final value that was off by several of its bounds where it had any; others had none, because it had not ended.
#[test]
fn a_first_stroke_from_elsewhere_is_no_late_part_of_the_response() {
    // The shaft comes to rest half of the play short of each level.
    let play = 0.14;
    let gain = 1.0 - play / STROKE;
    for seed in 0..6 {
        let found = identified(play, seed, Noise::White);
        assert!(begins_elsewhere(&found), "{seed}");
        let model = &found.model;
        let is_said = (model.advice.iter()).any(|advice| advice.check == Check::Start);
        assert!(is_said && model.bounds.valid().is_some(), "{seed}");
        let found = model.metrics.dc_gain;
        assert!(found.contains(gain), "{seed}: {found:?} for {gain}");
        assert!(model.structure.settling_samples < 250, "{seed}");
    }
}

#[test]
fn a_linear_servo_begins_where_it_rests() {
    let noises = [Noise::White, Noise::Ar1];
    for seed in 0..3 {
        for noise in noises {
            assert!(!begins_elsewhere(&identified(0.0, seed, noise)), "{seed}");
        }
    }
}

/// One in a thousand is chance; a dozen in three hundred would be another level.
#[test]
#[ignore = "a minute: cargo test -p servoid-identification --test integration -- --ignored linear_servos_begin"]
fn linear_servos_begin_where_they_rest() {
    let noises = [Noise::White, Noise::Ar1, Noise::Arma];
    let all = noises
        .iter()
        .flat_map(|noise| (100..200).map(move |seed| (seed, *noise)));
    let alarms = all
        .filter(|(seed, noise)| begins_elsewhere(&identified(0.0, *seed, *noise)))
        .count();
    assert!(alarms <= 4, "{alarms}");
}
