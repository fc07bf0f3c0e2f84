//! Sides of the drive that differ otherwise than in the equation: in their limit alone, or a motor that brakes more in one direction.
//!
//! In the equation top speeds and accelerations of the two directions differ by one factor, beside what a load does. Sides of the drive that differ
//! in their limit alone make the motion of a load and unequal drives, unless there is a dead band, in which a load pushes and they do not. Those that differ in their
//! stiffness alone make that of a load and unequal drives. What is left is the damping of the motor. A fit takes most of that for a load, unequal drives and a dead band,
//! and reached top speeds may be far from its own.

use super::stepped_outputs::{step_s, stepped_outputs};
use crate::servo_model::stretches::Stretch;
use servoid_dynamics::{DriveLimit, Grid, ServoParameters, Stepper};

/// By how much the side towards smaller θ has more, as a share. One size stands for all: the shape is that of a derivative.
const MORE: f64 = 0.1;

/// What unequal drives and unequal limits would take from the output of `servo` in each sample of a stretch \[output\]; `None` for a drive without limit, or whose speed is
/// cut off, that has unequal limits already, and without a dead band, where both are a load. The equation has the first: a fit may have left it out.
pub(super) fn limit_shortfalls(
    servo: &ServoParameters,
    stretch: &Stretch,
    grid: &Grid,
) -> Option<Vec<[f64; 2]>> {
    servo.dead_band?;
    let sides = DriveSides::of(servo, grid).filter(|sides| !sides.limit.at_one_stiffness)?;
    let others = [sides.drives(), sides.limits()].map(|both| [both, both]);
    Some(sides.taken_by(stretch, others))
}

/// What unequal drives, unequal limits and unequal motors would take likewise. A fit may have left out the first two, and none of that is the motor's.
pub(super) fn motor_shortfalls(
    servo: &ServoParameters,
    stretch: &Stretch,
    grid: &Grid,
) -> Option<Vec<[f64; 3]>> {
    let sides = DriveSides::of(servo, grid)?;
    let [drives, limits] = [sides.drives(), sides.limits()];
    let others = [
        [drives, drives],
        [limits, limits],
        [sides.own(), sides.braked()],
    ];
    Some(sides.taken_by(stretch, others))
}

/// A servo with a limit of its drive, whose speed is not cut off: the motor brakes nothing then.
struct DriveSides<'a> {
    servo: &'a ServoParameters,
    grid: &'a Grid,
    limit: DriveLimit<f64>,
}

impl<'a> DriveSides<'a> {
    fn of(servo: &'a ServoParameters, grid: &'a Grid) -> Option<Self> {
        let limit = servo.limit.filter(|_| servo.speed_limit.is_none())?;
        Some(Self { servo, grid, limit })
    }

    fn with(&self, limit: DriveLimit<f64>, damping: f64) -> Stepper<f64> {
        let other = ServoParameters {
            damping,
            limit: Some(limit),
            ..*self.servo
        };
        Stepper::new(&other, step_s(self.grid))
    }

    fn own(&self) -> Stepper<f64> {
        self.with(self.limit, self.servo.damping)
    }

    /// With all of the drive larger, as in the equation.
    fn drives(&self) -> Stepper<f64> {
        let down_to_up = self.limit.down_to_up * (1.0 + MORE);
        let limit = DriveLimit {
            down_to_up,
            ..self.limit
        };
        self.with(limit, self.servo.damping)
    }

    /// With a larger limit at one stiffness.
    fn limits(&self) -> Stepper<f64> {
        self.own().with_limit_downwards(1.0 + MORE)
    }

    /// With a motor that brakes more. What the loop brakes is the same: the whole damping grows with the motor's own.
    fn braked(&self) -> Stepper<f64> {
        let more = self.limit.motor_damping * MORE;
        let limit = DriveLimit {
            motor_damping: self.limit.motor_damping + more,
            ..self.limit
        };
        self.with(limit, self.servo.damping + more)
    }

    /// What other servos, towards larger and smaller θ, take from the output in each sample of a stretch.
    fn taken_by<const N: usize>(
        &self,
        stretch: &Stretch,
        others: [[Stepper<f64>; 2]; N],
    ) -> Vec<[f64; N]> {
        let outputs = |[larger, smaller]: [Stepper<f64>; 2]| {
            stepped_outputs(self.servo, stretch, self.grid, |state, command| {
                let stepper = if state.speed < 0.0 { &smaller } else { &larger };
                stepper.advance(state, command);
            })
        };
        let free = outputs([self.own(), self.own()]);
        let others = others.map(outputs);
        let sample = |k: usize| std::array::from_fn(|other| free[k] - others[other][k]);
        (0..free.len()).map(sample).collect()
    }
}
