//! The outputs of a servo that the equation does not have, step by step.

use crate::servo_model::stretches::Stretch;
use servoid_dynamics::{Grid, ServoParameters, State};

/// Length of a step of the integration \[s\].
pub(crate) fn step_s(grid: &Grid) -> f64 {
    grid.period_s / grid.steps as f64
}

/// The outputs under the commands of a stretch of a servo with the delay and the scale of `servo`, which `advance` moves by a step under a command.
pub(crate) fn stepped_outputs(
    servo: &ServoParameters,
    stretch: &Stretch,
    grid: &Grid,
    mut advance: impl FnMut(&mut State<f64>, f64),
) -> Vec<f64> {
    let start = &stretch.start;
    let delay = (servo.delay_s / step_s(grid)).round() as usize;
    let mut state = servo.state_at(start);
    let before = (start.command_before).unwrap_or_else(|| servo.holding_command(state.angle));
    let mut outputs = Vec::with_capacity(stretch.input.len());
    for step in 0..stretch.input.len() * grid.steps {
        if step % grid.steps == 0 {
            outputs.push(state.output(servo));
        }
        let command = match step.checked_sub(delay) {
            None => before,
            Some(since) => stretch.command_at(since, grid),
        };
        advance(&mut state, command);
    }
    outputs
}
