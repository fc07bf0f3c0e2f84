//! A lag between the drive and the motion, as of a motor's current or of a filter of the controller, which the equation does not have.
//!
//! A fit takes most of a short one for a longer delay, and of what is left for another dead band and friction. So the delay of a servo is that with such a lag: what the
//! lag does beyond a delay of its own length may hide in the other quantities.

use super::stepped_outputs::{step_s, stepped_outputs};
use crate::servo_model::stretches::Stretch;
use servoid_dynamics::{Grid, ServoParameters, Stepper};

/// The part of what is missing that the motor makes up for in a step of the integration; these are a twentieth of the reciprocal bandwidth at the most. One lag stands for all
/// short ones: the shape is that of a derivative.
const SHARE: f64 = 0.5;

/// The lag \[steps\], as a delay.
const STEPS: f64 = 1.0 / SHARE - 1.0;

/// What the lag would take from the output of a servo like `servo` that has a delay in its place, in each sample of a stretch \[output\].
pub(super) fn shortfall(
    servo: &ServoParameters,
    stretch: &Stretch,
    grid: &Grid,
) -> Option<Vec<[f64; 1]>> {
    let step_s = step_s(grid);
    let stepper = Stepper::new(servo, step_s);
    let late = ServoParameters {
        delay_s: servo.delay_s + STEPS * step_s,
        ..*servo
    };
    let delayed = stepped_outputs(&late, stretch, grid, |state, command| {
        stepper.advance(state, command);
    });
    let mut by_motor = None;
    let lagging = stepped_outputs(servo, stretch, grid, |state, command| {
        stepper.advance_by(state, command, |moved, unmoved| {
            let wanted = moved - unmoved;
            let before = by_motor.unwrap_or(wanted);
            let now = before + SHARE * (wanted - before);
            by_motor = Some(now);
            unmoved + now
        });
    });
    let apart = delayed.iter().zip(lagging);
    Some(
        apart
            .map(|(delayed, lagging)| [delayed - lagging])
            .collect(),
    )
}
