//! The damping of a motor beside a speed that is cut off, which the equation does not have.
//!
//! A controller that limits the speed leaves the motor as it is: full drive accelerates it less the faster it turns, and brakes it more. A fit takes the mean of both for the
//! acceleration, and the servo turns round at full speed sooner than that.

use super::stepped_outputs::{step_s, stepped_outputs};
use crate::servo_model::stretches::Stretch;
use servoid_dynamics::{DriveLimit, Grid, ServoParameters, Stepper};

/// What the damping takes of full drive at the speed that is cut off, as a share. One size stands for all: the shape is that of a derivative.
const SHARE: f64 = 0.2;

/// What the damping would take from the output of `servo` in each sample of a stretch \[output\]; `None` without a speed that is cut off, or without a limit of the drive.
pub(super) fn shortfall(
    servo: &ServoParameters,
    stretch: &Stretch,
    grid: &Grid,
) -> Option<Vec<[f64; 1]>> {
    let (limit, cut_off) = servo.limit.zip(servo.speed_limit)?;
    let [up, down] = cut_off.both_ways();
    let step_s = step_s(grid);
    let outputs = |motor_damping: f64| {
        let limit = DriveLimit {
            down_to_up: 1.0,
            motor_damping,
            at_one_stiffness: false,
            ..limit
        };
        let free = ServoParameters {
            limit: Some(limit),
            speed_limit: None,
            ..*servo
        };
        let stepper = Stepper::new(&free, step_s);
        stepped_outputs(servo, stretch, grid, |state, command| {
            stepper.advance(state, command);
            let excess = state.speed - state.speed.clamp(-down, up);
            state.speed -= excess;
            state.angle -= 0.5 * step_s * excess;
        })
    };
    let (undamped, damped) = (outputs(0.0), outputs(SHARE * limit.up / up.max(down)));
    Some(undamped.iter().zip(damped).map(|(y, z)| [y - z]).collect())
}
