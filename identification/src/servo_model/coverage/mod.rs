//! Whether the intervals hold, on servos drawn at random in the model's class and a little outside of it: the table of
//! docs/servo-model.md.

mod references;
mod servos;
mod table;
mod trial;
mod truth;

use super::coordinates::Terms;
use super::{ServoModelOptions, fit};
use crate::data::Record;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use references::{NoiseKind, PERIOD_S, Reference};
use servoid_dynamics::{Grid, Start, simulate};
use servos::{Kind, servo};
use trial::{Case, Trial};
use truth::{Beyond, Truth};

/// A number from the environment.
fn number(name: &str, otherwise: u64) -> u64 {
    let text = std::env::var(name).ok();
    text.and_then(|text| text.parse().ok()).unwrap_or(otherwise)
}

/// All recordings of a kind of servo, by reference and noise.
fn cases(kind: Kind, servos: std::ops::Range<u64>, runs: u64) -> Vec<Case> {
    let mut all = Vec::new();
    for reference in Reference::ALL {
        for noise in NoiseKind::ALL {
            for servo in servos.clone() {
                all.extend((0..runs).map(|run| Case {
                    kind,
                    servo,
                    reference,
                    noise,
                    run,
                }));
            }
        }
    }
    all
}

#[test]
#[ignore = "an hour; prints the table: cargo test --release -p servoid-identification --lib servo_model::coverage -- --ignored --nocapture"]
fn coverage_table() {
    let (first, servos, runs) = (number("FIRST", 0), number("SERVOS", 4), number("RUNS", 1));
    let each = std::env::var("EACH").is_ok();
    println!("{}", table::HEAD);
    for kind in Kind::ALL {
        let cases = cases(kind, first..first + servos, runs);
        let trials: Vec<Trial> = cases.into_par_iter().map(Case::trial).collect();
        for row in trials.chunks((servos * runs) as usize) {
            let row: Vec<&Trial> = row.iter().collect();
            println!("{}", table::row(&row));
            if each {
                for trial in &row {
                    println!("{}", table::line(trial));
                }
            }
        }
        let all: Vec<&Trial> = trials.iter().collect();
        println!("   {kind}: missed {:?}", table::misses(&all));
    }
}

/// Bands that are claimed hold most of the truth, within the class and outside of it.
#[test]
fn claimed_bands_hold() {
    let case = |kind| Case {
        kind,
        servo: 5,
        reference: Reference::RandomLevels,
        noise: NoiseKind::White,
        run: 0,
    };
    let trials: Vec<Trial> = Kind::ALL
        .into_par_iter()
        .map(|kind| case(kind).trial())
        .collect();
    let [in_class, beyond @ ..] = &trials[..] else {
        unreachable!("kinds")
    };
    assert!(in_class.claim.is_some(), "withdrawn within the class");
    for trial in std::iter::once(in_class).chain(beyond) {
        if let Some(claim) = &trial.claim {
            println!("{}", table::line(trial));
            // The level is 99 %; single recordings of the table go down to 88 %.
            assert!(claim.band_inside > 0.9, "{}", table::line(trial));
        }
    }
}

/// The truth of a servo of the class is that of the model's equation: two schemes give the same motion.
#[test]
fn truth_within_the_class_is_the_equation() {
    for seed in 0..12 {
        let truth = servo(Kind::InClass, seed);
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let input = Reference::RandomLevels.command(&mut random, 1000);
        let physics = truth.point.physics(0, |_, value| value);
        let grid = Grid::new(PERIOD_S, 0.0, 1e-5);
        let start = Start::at_rest(physics.resting_output(input[0]), Some(input[0]));
        let mut worst: f64 = 0.0;
        let theirs = truth.response(&input, PERIOD_S);
        simulate(&physics, &grid, &start, &input, |k, y| {
            worst = worst.max((y - theirs[k]).abs());
        });
        println!("servo {seed}: {worst:.5} deg");
        // A tenth of the noise of a sample: no interval of these recordings is that narrow anywhere.
        assert!(worst < 0.003, "servo {seed}: {worst}");
    }
}

/// Linear servos hardly ever get terms that they do not have.
#[test]
#[ignore = "minutes: cargo test --release -p servoid-identification --lib linear_servos_stay_linear -- --ignored --nocapture"]
fn linear_servos_stay_linear() {
    let runs: Vec<u64> = (0..number("RUNS", 20)).collect();
    let linear = |seed: &u64| {
        let drawn = servo(Kind::InClass, 7000 + seed);
        let truth = Truth {
            point: drawn.point.with_terms(Terms::default(), 1, |_| 0.0),
            beyond: Beyond::Nothing,
        };
        let mut random = ChaCha8Rng::seed_from_u64(*seed);
        let input = Reference::ALL[(*seed % 3) as usize].command(&mut random, 3600);
        let noise = NoiseKind::ALL[(*seed % 2) as usize].draw(&mut random, input.len());
        let clean = truth.response(&input, PERIOD_S);
        let output: Vec<f64> = clean.iter().zip(noise).map(|(y, v)| y + v).collect();
        let record = Record::from_slices(PERIOD_S, &input, &output).unwrap();
        fit(&record, &ServoModelOptions::default())
            .unwrap()
            .is_linear()
    };
    let stayed = runs.par_iter().filter(|seed| linear(seed)).count();
    println!("{stayed} of {} stayed linear", runs.len());
    // 39 of 40 measured, less three standard deviations of twenty runs.
    assert!(
        100 * stayed >= 85 * runs.len(),
        "{stayed} of {}",
        runs.len()
    );
}
