//! A lag between the drive and the motion, as of a motor's current or of a filter of the controller, which the equation does not have.
//!
//! A fit takes most of a short one for a longer delay, and of what is left for another dead band and friction.

use super::stepped_outputs::{step_s, stepped_outputs};
use crate::servo_model::stretches::Stretch;
use servoid_dynamics::{Grid, ServoParameters, Stepper};

/// The lag in steps of the integration, which are a twentieth of the reciprocal bandwidth at the most. One lag stands for all short ones: the shape is that of a
/// derivative.
const STEPS: f64 = 2.0;

/// What the lag would take from the output of `servo` in each sample of a stretch \[output\]. All that accelerates but the load lags, friction too.
pub(super) fn shortfall(
    servo: &ServoParameters,
    stretch: &Stretch,
    grid: &Grid,
) -> Option<Vec<[f64; 1]>> {
    let step_s = step_s(grid);
    let stepper = Stepper::new(servo, step_s);
    let outputs = |share: f64| {
        let mut lagged = 0.0;
        stepped_outputs(servo, stretch, grid, |state, command| {
            let before = *state;
            stepper.advance(state, command);
            let load = servo.load.at(before.angle) * step_s;
            let change = state.speed - before.speed + load;
            lagged += share * (change - lagged);
            let excess = change - lagged;
            state.speed -= excess;
            state.angle -= 0.5 * step_s * excess;
        })
    };
    let (free, late) = (outputs(1.0), outputs(1.0 / STEPS));
    Some(free.iter().zip(late).map(|(y, z)| [y - z]).collect())
}
