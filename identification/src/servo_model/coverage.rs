//! Whether the intervals hold, on servos of the model's class drawn at random: the table of docs/servo-model.md.

use super::coordinates::{Coordinate, LoadKind, Point, Terms};
use super::{ServoModel, ServoModelOptions, fit};
use crate::data::{Record, Run};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use rayon::prelude::*;
use servoid_dynamics::{Grid, Start, simulate};

const PERIOD_S: f64 = 0.002;

/// A servo within the stated ranges. Commands of the references are ±5 degrees.
fn servo(seed: u64) -> Point {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let loads = [LoadKind::None, LoadKind::Constant, LoadKind::None];
    let terms = Terms {
        limit: true,
        two_speeds: seed % 2 == 1,
        dead_band: seed % 3 == 1,
        friction: seed % 3 == 2,
        load: loads[seed as usize / 3 % 3],
    };
    let mut point = Point {
        terms,
        coordinates: terms.coordinates(1),
        values: Vec::new(),
        radians: 1f64.to_radians(),
    };
    let mut between = |low: f64, high: f64| random.random_range(low..high);
    let bandwidth = between(25.0, 70.0);
    let (damping, full_drive, share) = (
        2.0 * between(0.6, 1.1) * bandwidth,
        between(1.0, 4.0),
        between(0.2, 0.6),
    );
    let top_speed = full_drive * bandwidth * bandwidth / (share * damping);
    point.values = point
        .coordinates
        .iter()
        .map(|at| match at {
            Coordinate::Delay => between(0.006, 0.04),
            Coordinate::LnStiffness => 2.0 * bandwidth.ln(),
            Coordinate::LnDamping => damping.ln(),
            Coordinate::Gain => between(0.8, 1.2),
            Coordinate::Offset => between(-1.0, 1.0),
            Coordinate::LnTopSpeed => top_speed.ln(),
            Coordinate::MotorShare => share,
            Coordinate::LnDownToUp => between(-0.4, 0.4),
            Coordinate::DeadBand => between(0.1, 0.4),
            Coordinate::Friction => between(0.05, 0.3),
            Coordinate::FrictionAtRest => between(0.0, 1.0),
            Coordinate::LnFrictionSpeedShare => between(0.02, 0.2).ln(),
            Coordinate::ConstantLoad => between(-0.5, 0.5),
            _ => 0.0,
        })
        .collect();
    point
}

/// Levels of the command, each with its number of samples.
fn reference(kind: usize, random: &mut ChaCha8Rng, samples: usize) -> Vec<f64> {
    let mut input = Vec::new();
    let mut up = false;
    let mut hold = 0;
    while input.len() < samples {
        up = !up;
        hold += 1;
        let level = if up { 5.0 } else { -5.0 };
        let (level, length) = match kind {
            // Holds that become shorter.
            0 => (level, (400 - 20 * (hold % 18)).max(50)),
            // Random levels, holds of 100 to 400 ms.
            1 => (random.random_range(-5.0..5.0), random.random_range(50..200)),
            // A random telegraph of frames.
            _ => (
                if random.random_bool(0.5) { 5.0 } else { -5.0 },
                10 * random.random_range(2..12),
            ),
        };
        input.extend(std::iter::repeat_n(level, length));
    }
    input.truncate(samples);
    input
}

/// The response computed ten times as finely as the model does.
fn response(point: &Point, input: &[f64]) -> Vec<f64> {
    let physics = point.physics(0, |_, value| value);
    let grid = Grid::new(PERIOD_S, 0.0, 1e-4);
    let start = Start::at_rest(physics.resting_output(input[0]), Some(input[0]));
    let mut output = Vec::new();
    simulate(&physics, &grid, &start, input, |_, y| output.push(y));
    output
}

fn noise(kind: usize, random: &mut ChaCha8Rng, samples: usize) -> Vec<f64> {
    let white = |random: &mut ChaCha8Rng| -> f64 { StandardNormal.sample(random) };
    let mut state = 0.0;
    (0..samples)
        .map(|_| match kind {
            0 => 0.03 * white(random),
            _ => {
                state = 0.8 * state + 0.03 * white(random);
                state
            }
        })
        .collect()
}

/// One run: the fit, and the truth.
struct Trial {
    truth: Point,
    found: ServoModel,
}

fn trial(servo_seed: u64, kind: usize, noise_kind: usize, seed: u64) -> Trial {
    let truth = servo(servo_seed);
    let mut random = ChaCha8Rng::seed_from_u64(
        1000 * seed + 10 * servo_seed + (3 * noise_kind + kind) as u64 * 1_000_000,
    );
    let input = reference(kind, &mut random, 3600);
    let clean = response(&truth, &input);
    let noise = noise(noise_kind, &mut random, input.len());
    let output: Vec<f64> = clean.iter().zip(noise).map(|(y, v)| y + v).collect();
    let run = Run::new(input.clone(), output)
        .unwrap()
        .with_input_at_rest(input[0]);
    let record = Record::new(PERIOD_S, vec![run]).unwrap();
    let found = fit(&record, &ServoModelOptions::default()).unwrap();
    Trial { truth, found }
}

/// Of each quantity: name, how often determined, how often its interval has the truth.
fn counted(trials: &[Trial]) -> Vec<(String, usize, usize)> {
    let mut counts: Vec<(String, usize, usize)> = Vec::new();
    for trial in trials {
        let truths = super::quantities::values(&trial.truth);
        for found in trial
            .found
            .quantities
            .iter()
            .filter(|found| found.determined)
        {
            let Some(interval) = found.interval.valid() else {
                continue;
            };
            let Some((_, truth)) = truths.iter().find(|(name, _)| *name == found.name) else {
                continue;
            };
            let index = counts
                .iter()
                .position(|(name, ..)| *name == found.name)
                .unwrap_or_else(|| {
                    counts.push((found.name.clone(), 0, 0));
                    counts.len() - 1
                });
            counts[index].1 += 1;
            counts[index].2 += usize::from(interval.contains(*truth));
        }
    }
    counts
}

/// Share of the samples of a new command's response whose band has the truth.
fn band_coverage(trial: &Trial) -> Option<f64> {
    let mut random = ChaCha8Rng::seed_from_u64(77);
    let input = reference(1, &mut random, 1500);
    let truth = response(&trial.truth, &input);
    let found = trial.found.respond(&input, 0);
    let half = found.half_width.valid()?;
    let inside = found
        .value
        .iter()
        .zip(&truth)
        .zip(half)
        .filter(|((a, b), half)| (*a - *b).abs() <= **half + 1e-9);
    Some(inside.count() as f64 / input.len() as f64)
}

#[test]
#[ignore = "minutes; prints the table"]
fn coverage_table() {
    let runs: u64 = std::env::var("RUNS")
        .ok()
        .and_then(|runs| runs.parse().ok())
        .unwrap_or(1);
    let first: u64 = std::env::var("FIRST")
        .ok()
        .and_then(|first| first.parse().ok())
        .unwrap_or(0);
    let servos: u64 = std::env::var("SERVOS")
        .ok()
        .and_then(|runs| runs.parse().ok())
        .unwrap_or(4);
    for kind in 0..3 {
        for noise_kind in 0..2 {
            let cases: Vec<(u64, u64)> = (first..first + servos)
                .flat_map(|s| (0..runs).map(move |r| (s, r)))
                .collect();
            let trials: Vec<Trial> = cases
                .par_iter()
                .map(|&(s, r)| trial(s, kind, noise_kind, r))
                .collect();
            let bands: Vec<f64> = trials.iter().filter_map(band_coverage).collect();
            let right = trials
                .iter()
                .filter(|t| t.found.terms == t.truth.terms)
                .count();
            let counts = counted(&trials);
            let (all, inside) = counts
                .iter()
                .fold((0, 0), |(a, b), (_, n, k)| (a + n, b + k));
            println!(
                "reference {kind} noise {noise_kind}: intervals {:.1} % of {all}, bands {:.1} % of {} (worst {:.1}), terms right {right} of {}",
                100.0 * inside as f64 / all as f64,
                100.0 * bands.iter().sum::<f64>() / bands.len() as f64,
                bands.len(),
                100.0 * bands.iter().fold(1.0, |a: f64, b| a.min(*b)),
                trials.len()
            );
            for (name, count, inside) in counts {
                println!("   {name}: {inside} of {count}");
            }
            if std::env::var("EACH").is_ok() {
                for (trial, (s, _)) in trials.iter().zip(&cases) {
                    println!(
                        "   servo {s}: {:?} -> {:?} and {} more, fit {:.2} bands {:?}",
                        trial.truth.terms,
                        trial.found.terms,
                        trial.found.alternatives.len(),
                        trial.found.fit.simulation_percent,
                        band_coverage(trial)
                    );
                }
            }
        }
    }
}

/// Linear servos hardly ever get terms that they do not have.
#[test]
#[ignore = "minutes"]
fn linear_servos_stay_linear() {
    let count = std::env::var("RUNS")
        .ok()
        .and_then(|runs| runs.parse().ok())
        .unwrap_or(20);
    let runs: Vec<u64> = (0..count).collect();
    let linear = |seed: &u64| {
        let mut truth = servo(7000 + seed);
        truth = truth.with_terms(Terms::default(), 1, |_| 0.0);
        let mut random = ChaCha8Rng::seed_from_u64(*seed);
        let input = reference((*seed % 3) as usize, &mut random, 3600);
        let noise = noise((*seed % 2) as usize, &mut random, input.len());
        let output: Vec<f64> = response(&truth, &input)
            .iter()
            .zip(noise)
            .map(|(y, v)| y + v)
            .collect();
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
