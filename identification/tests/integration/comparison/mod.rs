//! The same servo is never called different, a different one is.

mod bounds;
mod own_structures;
mod runs;
mod scales;
mod shifts;
mod verdicts;

use servoid_identification::comparison::ComparisonOptions;
use servoid_identification::{Options, Record, Run, Settling};
use servoid_test_support::servos::{Linear, PERIOD, measured, respond_by_stroke, staircase};

fn servo() -> Linear {
    Linear::second_order(0.97, 0.0255, 0.5, 60.0)
}

fn options() -> ComparisonOptions {
    ComparisonOptions {
        identification: Options {
            settling: Settling::Samples(131),
            ..Options::default()
        },
        ..ComparisonOptions::default()
    }
}

/// Runs that differ in their noise, and in gain and delay by `scatter` of 1 % and 0.2 ms.
fn record(
    up: &Linear,
    down: &Linear,
    zero: f64,
    seeds: std::ops::Range<u64>,
    scatter: f64,
) -> Record<'static> {
    let input = staircase();
    let runs = seeds.map(|seed| {
        let part =
            |k: u64| scatter * (((seed * 7 + k) * 2_654_435_761 % 1000) as f64 / 500.0 - 1.0);
        let changed = |servo: &Linear| {
            let mut servo = servo.clone();
            servo.gain *= 1.0 + 0.01 * part(1);
            servo.delay_s += 0.0002 * part(2);
            servo
        };
        let clean: Vec<f64> = respond_by_stroke(&changed(up), &changed(down), &input, -5.0, 0.0)
            .iter()
            .map(|y| y + zero)
            .collect();
        Run::new(input.clone(), measured(&clean, 1.0, seed)).unwrap()
    });
    Record::new(PERIOD, runs.collect()).unwrap()
}

fn plain(servo: &Linear, seed: u64) -> Record<'static> {
    record(servo, servo, 0.0, seed..seed + 1, 0.0)
}
