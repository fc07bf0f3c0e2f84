//! Friction at rest that is gone at a lower speed than the servo has it, or that the fit has left out.

use crate::servo_model::stretches::Stretch;
use servoid_dynamics::{AtRest, Friction, Grid, ServoParameters, simulate};

/// The speed at which half of the excess is gone, as a share of that of the servo. One share stands for all: below it the shaft hardly moves.
const SPEED_SHARE: f64 = 0.2;

/// The excess over friction in motion, where the fit has found less.
const EXCESS: f64 = 1.0;

/// What such friction would take from the output of `servo` in each sample of a stretch \[output\]; `None` for a servo without friction.
pub(super) fn shortfall(
    servo: &ServoParameters,
    stretch: &Stretch,
    grid: &Grid,
) -> Option<Vec<[f64; 1]>> {
    let sticking = ServoParameters {
        friction: Some(sticking(servo)?),
        ..*servo
    };
    let [free, stuck] = [servo, &sticking].map(|servo| outputs(servo, stretch, grid));
    Some(free.iter().zip(stuck).map(|(y, z)| [y - z]).collect())
}

/// The friction of a servo, with more of it at rest and at the lowest speeds alone.
fn sticking(servo: &ServoParameters) -> Option<Friction<f64>> {
    let friction = servo.friction?;
    let found = friction.at_rest?;
    let speed = SPEED_SHARE * found.speed;
    let excess = found.excess.max(EXCESS);
    Some(Friction {
        at_rest: Some(AtRest { excess, speed }),
        ..friction
    })
}

fn outputs(servo: &ServoParameters, stretch: &Stretch, grid: &Grid) -> Vec<f64> {
    let mut outputs = Vec::with_capacity(stretch.input.len());
    simulate(servo, grid, &stretch.start, stretch.commands(), |_, y| {
        outputs.push(y);
    });
    outputs
}
