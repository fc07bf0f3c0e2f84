//! A motor that brakes more in one direction, which the equation does not have.
//!
//! In the equation top speeds and accelerations of the two directions differ by one factor, beside what a load does. Sides of the drive that differ
//! in their limit alone make the motion of a load; those that differ in their stiffness alone that of a load and unequal drives. What is
//! left is the damping of the motor. A fit takes most of that for a load, unequal drives and a dead band, and reached top speeds may be far from its own.

use super::stepped_outputs::{step_s, stepped_outputs};
use crate::servo_model::stretches::Stretch;
use servoid_dynamics::{DriveLimit, Grid, ServoParameters, Stepper};

/// By how much the side towards smaller θ has more, as a share. One size stands for all: the shape is that of a derivative.
const MORE: f64 = 0.1;

/// What unequal drives, unequal limits and unequal motors would take from the output of `servo` in each sample of a stretch \[output\]; `None` for
/// a drive without limit, and where the speed is cut off: the motor brakes nothing then. The equation has the first two: a fit may have left them out, and none of that is the motor's.
pub(super) fn shortfalls(
    servo: &ServoParameters,
    stretch: &Stretch,
    grid: &Grid,
) -> Option<Vec<[f64; 3]>> {
    let limit = servo.limit.filter(|_| servo.speed_limit.is_none())?;
    let with = |limit: DriveLimit<f64>, damping: f64| {
        let other = ServoParameters {
            damping,
            limit: Some(limit),
            ..*servo
        };
        Stepper::new(&other, step_s(grid))
    };
    let own = with(limit, servo.damping);
    let down_to_up = limit.down_to_up * (1.0 + MORE);
    let drives = with(
        DriveLimit {
            down_to_up,
            ..limit
        },
        servo.damping,
    );
    let limits = own.with_limit_downwards(1.0 + MORE);
    // What the loop brakes is the same: the whole damping grows with the motor's own.
    let more = limit.motor_damping * MORE;
    let motor_damping = limit.motor_damping + more;
    let braked = with(
        DriveLimit {
            motor_damping,
            ..limit
        },
        servo.damping + more,
    );
    let outputs = |[larger, smaller]: [Stepper<f64>; 2]| {
        stepped_outputs(servo, stretch, grid, |state, command| {
            let stepper = if state.speed < 0.0 { &smaller } else { &larger };
            stepper.advance(state, command);
        })
    };
    let free = outputs([own, own]);
    let others = [[drives, drives], [limits, limits], [own, braked]].map(outputs);
    let sample = |k: usize| [0, 1, 2].map(|other| free[k] - others[other][k]);
    Some((0..free.len()).map(sample).collect())
}
