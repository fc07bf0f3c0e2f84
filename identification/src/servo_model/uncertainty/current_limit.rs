//! A limit of the motor's current, which the equation does not have.
//!
//! It limits the torque to a share of what full drive gives at standstill, so that strokes begin and end with a smaller
//! acceleration. A fit takes most of that for a longer delay and other top speeds.

use super::stepped_outputs::{step_s, stepped_outputs};
use crate::servo_model::stretches::Stretch;
use servoid_dynamics::{Grid, ServoParameters, State, Stepper};

/// The largest torque, as a share of that of full drive at standstill. One share stands for all: limits have one shape.
const SHARE: f64 = 0.7;

/// What the limit would take from the output of `servo` in each sample of a stretch \[output\]; `None` where the drive has no limit of its
/// own, and nothing is known of the torque.
pub(super) fn shortfall(
    servo: &ServoParameters,
    stretch: &Stretch,
    grid: &Grid,
) -> Option<Vec<[f64; 1]>> {
    let most = servo.limit?.up * SHARE;
    let outputs = |most: f64| {
        let servo = *servo;
        let step_s = step_s(grid);
        Weak {
            servo,
            most,
            step_s,
        }
        .outputs(stretch, grid)
    };
    let (free, limited) = (outputs(f64::INFINITY), outputs(most));
    Some(free.iter().zip(limited).map(|(y, z)| [y - z]).collect())
}

/// A servo whose motor has a largest torque.
struct Weak {
    servo: ServoParameters,
    /// The largest torque upwards.
    most: f64,
    step_s: f64,
}

impl Weak {
    fn outputs(&self, stretch: &Stretch, grid: &Grid) -> Vec<f64> {
        let stepper = Stepper::new(&self.servo, self.step_s);
        stepped_outputs(&self.servo, stretch, grid, |state, command| {
            self.advance(&stepper, state, command);
        })
    }

    /// One step, in which the torque behind the change of speed is limited; friction counts as part of it.
    fn advance(&self, stepper: &Stepper<f64>, state: &mut State<f64>, command: f64) {
        let before = *state;
        stepper.advance(state, command);
        let load = self.servo.load.at(before.angle) * self.step_s;
        let most = self.most * self.step_s;
        let least = -most * self.servo.limit.map_or(1.0, |limit| limit.down_to_up);
        let change = (state.speed - before.speed + load).clamp(least, most) - load;
        let excess = state.speed - (before.speed + change);
        state.speed -= excess;
        state.angle -= 0.5 * self.step_s * excess;
    }
}
