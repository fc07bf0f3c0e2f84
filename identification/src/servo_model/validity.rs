//! Evidence on whether the errors of a servo model are noise.
//!
//! Noise does not follow the command; a score test shows where errors do. And it is there at rest as well as in motion: where
//! the errors one step ahead are larger in motion, the model is wrong there, or its fit lies in a poor minimum. Where
//! nothing of the record is at rest, nothing shows that they are noise.

use super::coordinates::Point;
use super::lack_of_fit;
use super::stretches::Stretch;
use super::uncertainty::Uncertainty;
use crate::estimation::noise_filter;
use crate::results::Reason;
use crate::thresholds::{MOTION_NOISE_CHANCE, MOTION_NOISE_RATIO, SERVO_LACK_OF_FIT};
use servoid_dynamics::Grid;

/// Speed that counts as motion, as a share of the largest.
const MOVING: f64 = 0.02;

/// Samples at rest that show the noise.
const SAMPLES_AT_REST: usize = 100;

/// Levels of the command from which on a record distinguishes gain, offset, friction, dead band and load: each shapes the line
/// through the positions of rest, and between two of these any fits. A servo that seems to have none of them may have
/// them all the same, and not follow a third level as the model does.
const LEVELS: usize = 3;

/// What speaks against intervals of `point`.
pub(super) fn against(
    stretches: &[Stretch],
    grid: &Grid,
    point: &Point,
    found: &Uncertainty,
) -> Option<Reason> {
    if levels(stretches) < LEVELS {
        return Some(Reason::InputUnexcited);
    }
    let p = lack_of_fit::p_value(stretches, grid, point, found);
    let follow = p.is_some_and(|p| p < SERVO_LACK_OF_FIT);
    (follow || grows_with_motion(stretches, found)).then_some(Reason::ErrorsNotNoise)
}

/// Different commands, up to three.
fn levels(stretches: &[Stretch]) -> usize {
    let mut found: Vec<f64> = Vec::new();
    for command in stretches.iter().flat_map(|stretch| &stretch.input) {
        if !found.contains(command) {
            found.push(*command);
            if found.len() == LEVELS {
                break;
            }
        }
    }
    found.len()
}

/// Whether the errors one step ahead are larger in motion than at rest, beyond chance and by more than a little.
fn grows_with_motion(stretches: &[Stretch], found: &Uncertainty) -> bool {
    let d = noise_filter(&found.ar);
    let errors = found.errors();
    // The motion is that of the simulation: measured output less error.
    let simulated: Vec<Vec<f64>> = stretches
        .iter()
        .zip(&errors)
        .map(|(stretch, errors)| {
            stretch
                .output
                .iter()
                .zip(errors)
                .map(|(y, e)| y - e)
                .collect()
        })
        .collect();
    let step = |pair: &[f64]| (pair[1] - pair[0]).abs();
    // `f64::max` passes over what is missing.
    let steps = simulated.iter().flat_map(|run| run.windows(2).map(step));
    let fastest = steps.fold(0.0, f64::max);
    let (mut at_rest, mut moving) = ((0usize, 0.0), (0usize, 0.0));
    for (simulated, errors) in simulated.iter().zip(&errors) {
        for k in d.len()..errors.len() {
            let ahead: f64 = d.iter().enumerate().map(|(i, d)| d * errors[k - i]).sum();
            let step = step(&simulated[k - 1..=k]);
            if ahead.is_nan() || step.is_nan() {
                continue;
            }
            let side = if step > MOVING * fastest {
                &mut moving
            } else {
                &mut at_rest
            };
            side.0 += 1;
            side.1 += ahead * ahead;
        }
    }
    if at_rest.0 < SAMPLES_AT_REST || moving.0 == 0 {
        return true;
    }
    let (rest_count, moving_count) = (at_rest.0 as f64, moving.0 as f64);
    let ratio = (moving.1 / moving_count) / (at_rest.1 / rest_count);
    // The logarithm of a mean of n squares of Gaussian noise has the variance 2/n.
    let chance = MOTION_NOISE_CHANCE * (2.0 / rest_count + 2.0 / moving_count).sqrt();
    ratio.is_nan() || ratio > MOTION_NOISE_RATIO && ratio.ln() > chance
}
