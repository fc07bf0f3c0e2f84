//! Symmetric servos stay symmetric, and asymmetric ones are described.

use super::{DirectionModel, split_with};
use crate::data::Record;
use crate::estimation::FsfBasis;
use crate::options::NoiseOrder;
use crate::results::{Bounds, StepResponse};
use rayon::prelude::*;

use servoid_test_support::servos::{Linear, PERIOD, measured, respond_by_stroke, staircase};

const SETTLING: usize = 151;

fn fast() -> Linear {
    Linear::second_order(0.95, 0.0215, 0.5, 60.0)
}

fn slow() -> Linear {
    Linear::second_order(0.95, 0.0255, 0.6, 45.0)
}

fn model(up: &Linear, down: &Linear, zero: f64, seed: u64, level: f64) -> DirectionModel {
    let input = staircase();
    let clean: Vec<f64> = respond_by_stroke(up, down, &input, -5.0, 0.0)
        .iter()
        .map(|y| y + zero)
        .collect();
    let record = Record::of_run(PERIOD, input, measured(&clean, 1.0, seed)).unwrap();
    split_with(
        &record,
        FsfBasis::full(SETTLING).unwrap(),
        NoiseOrder::Auto,
        Bounds::Valid(level),
        |_| false,
    )
    .unwrap()
}

#[test]
fn linear_servos_are_called_symmetric() {
    let wrong = (0..40u64)
        .into_par_iter()
        .filter(|seed| model(&fast(), &fast(), 0.0, *seed, 0.99).asymmetric())
        .count();
    // 1 % of 40 is 0.4; three or more have a probability of 0.7 %.
    assert!(wrong <= 2, "{wrong} of 40");
}

#[test]
fn both_strokes_and_both_levels_of_an_asymmetric_servo_are_found() {
    let level = 0.9;
    let runs = 40;
    let found: Vec<[f64; 4]> = (0..runs)
        .into_par_iter()
        .map(|seed| {
            let both = model(&slow(), &fast(), -0.5, seed, level);
            let symmetry = both.symmetry.valid().unwrap();
            assert!(symmetry.asymmetric && symmetry.p < 1e-6);
            assert!(
                both.simulation_percent > 98.0,
                "{}",
                both.simulation_percent
            );
            let inside = |step: &StepResponse, servo: &Linear| {
                let each = &step.bounds.valid().unwrap().pointwise;
                let (lower, upper) = (&each.lower, &each.upper);
                let held = (0..SETTLING).filter(|&m| {
                    let exact = servo.step(m as f64 * PERIOD);
                    (lower[m]..=upper[m]).contains(&exact)
                });
                held.count() as f64 / SETTLING as f64
            };
            let reaches = |command: f64| {
                f64::from(u8::from(
                    both.level_at(command).contains(0.95 * command - 0.5),
                ))
            };
            [
                inside(&both.up, &slow()),
                inside(&both.down, &fast()),
                reaches(5.0),
                reaches(-5.0),
            ]
        })
        .collect();
    for (k, name) in ["up", "down", "level +5", "level -5"].iter().enumerate() {
        let share = found.iter().map(|run| run[k]).sum::<f64>() / runs as f64;
        // Levels: 40 runs at 90 %, three standard deviations of 4.7 % below. Curves average over
        // many points, but what a bank of 31 leaves out of the split costs a few of them.
        assert!(share > 0.76, "{name}: {share}");
    }
}

#[test]
fn the_unit_of_the_command_changes_no_difference_between_strokes() {
    let in_degrees = model(&slow(), &fast(), 0.0, 1, 0.99);
    let input: Vec<f64> = staircase()
        .iter()
        .map(|degrees| 1500.0 + 11.0 * degrees)
        .collect();
    let clean = respond_by_stroke(&slow(), &fast(), &staircase(), -5.0, 0.0);
    let record = Record::of_run(PERIOD, input, measured(&clean, 1.0, 1)).unwrap();
    let in_pulses = split_with(
        &record,
        FsfBasis::full(SETTLING).unwrap(),
        NoiseOrder::Auto,
        Bounds::Valid(0.99),
        |_| false,
    )
    .unwrap();
    let of = |model: &DirectionModel| {
        let found = model.symmetry.valid().unwrap();
        (found.largest_difference, found.asymmetric)
    };
    let ((pulses, also_asymmetric), (degrees, asymmetric)) = (of(&in_pulses), of(&in_degrees));
    // The same numbers in another unit: only rounding differs.
    assert!(
        (pulses / degrees - 1.0).abs() < 1e-6,
        "{pulses} for {degrees}"
    );
    assert!(asymmetric && also_asymmetric);
}
