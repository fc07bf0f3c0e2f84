//! A limit of the motor's current, which the equation does not have.
//!
//! It limits the torque to a share of what full drive gives at standstill, so that strokes begin and end with a smaller
//! acceleration. A fit takes most of that for a longer delay and other top speeds.

use super::stretches::Stretch;
use servoid_dynamics::{Grid, ServoParameters, State, Stepper};

/// The largest torque, as a share of that of full drive at standstill. One share stands for all: limits have one shape.
const SHARE: f64 = 0.7;

/// What the limit would take from the output of `servo` in each sample of a stretch \[output\]; `None` where the drive has no limit of its
/// own, and nothing is known of the torque.
pub(super) fn shortfall(
    servo: &ServoParameters,
    stretch: &Stretch,
    grid: &Grid,
) -> Option<Vec<f64>> {
    let most = servo.limit?.up * SHARE;
    let free = Weak::new(*servo, f64::INFINITY, grid).outputs(stretch);
    let limited = Weak::new(*servo, most, grid).outputs(stretch);
    Some(free.iter().zip(limited).map(|(y, z)| y - z).collect())
}

/// A servo whose motor has a largest torque.
struct Weak {
    servo: ServoParameters,
    /// The largest torque upwards, and in steps of the integration the period and the delay.
    most: f64,
    steps: usize,
    delay: usize,
    step_s: f64,
}

impl Weak {
    fn new(servo: ServoParameters, most: f64, grid: &Grid) -> Self {
        let step_s = grid.period_s / grid.steps as f64;
        Self {
            servo,
            most,
            steps: grid.steps,
            delay: (servo.delay_s / step_s).round() as usize,
            step_s,
        }
    }

    /// The outputs under the commands of a stretch.
    fn outputs(&self, stretch: &Stretch) -> Vec<f64> {
        let (servo, start) = (&self.servo, &stretch.start);
        let stepper = Stepper::new(servo, self.step_s);
        let mut state = State {
            angle: (start.output - servo.offset) / servo.gain,
            speed: start.rate / servo.gain,
        };
        let before = (start.command_before).unwrap_or_else(|| servo.holding_command(state.angle));
        let mut outputs = Vec::with_capacity(stretch.input.len());
        for step in 0..stretch.input.len() * self.steps {
            if step % self.steps == 0 {
                outputs.push(state.angle * servo.gain + servo.offset);
            }
            let command = match step.checked_sub(self.delay) {
                None => before,
                Some(since) => stretch.input[since / self.steps],
            };
            self.advance(&stepper, &mut state, command);
        }
        outputs
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
