//! The equation in steps of one length, as the files for C, Python, Julia and MATLAB compute it.

use super::subject::ServoExport;
use crate::presentation::export::error::ExportError;
use servoid_dynamics::{Grid, State, Stepper};

/// Longest step times the bandwidth ω at small signals: beyond, the motion is wrong by percents of a stroke.
const LONGEST: f64 = 0.5;

/// Steps without a choice \[s\]: such as loops have.
const ROUND_S: [f64; 7] = [1e-2, 5e-3, 2e-3, 1e-3, 5e-4, 2e-4, 1e-4];

/// The delay in steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct DelayInSteps {
    /// Whole steps.
    pub whole: usize,
    /// The rest, 0 to 1.
    pub fraction: f64,
}

impl DelayInSteps {
    pub fn new(delay_s: f64, step_s: f64) -> Self {
        let steps = delay_s / step_s;
        // A whole number of steps but for rounding is one.
        let whole = (steps + 1e-9).floor();
        Self {
            whole: whole as usize,
            fraction: (steps - whole).max(0.0),
        }
    }

    /// The delayed commands of the step `k`, before and after the one changes to the other; commands before the first are
    /// equal to it.
    fn late(&self, command: &[f64], k: usize) -> (f64, f64) {
        let at = |back: usize| {
            let place = k.saturating_sub(back);
            command.get(place).copied().unwrap_or(f64::NAN)
        };
        (at(self.whole + 1), at(self.whole))
    }
}

/// The longest step in which the motion of this servo can be computed \[s\].
pub(super) fn longest_s(export: &ServoExport<'_>) -> f64 {
    LONGEST / export.parameters.stiffness.sqrt()
}

/// The step that was chosen, if one was.
///
/// # Errors
/// It is too long for the servo.
pub(super) fn chosen_step_s(export: &ServoExport<'_>) -> Result<Option<f64>, ExportError> {
    let longest_s = longest_s(export);
    match export.options.step_s {
        Some(step_s) if step_s > longest_s => Err(ExportError::StepTooLong {
            step_ms: 1e3 * step_s,
            longest_ms: 1e3 * longest_s,
        }),
        chosen => Ok(chosen),
    }
}

/// The step that was chosen, or the round one that is no longer than that of servoid's integrator.
///
/// # Errors
/// The chosen step is too long for the servo.
pub(super) fn step_s(export: &ServoExport<'_>) -> Result<f64, ExportError> {
    match chosen_step_s(export)? {
        Some(step_s) => Ok(step_s),
        None => {
            let usual = Grid::for_stiffness(1.0, 0.0, export.parameters.stiffness);
            let longest_s = usual.period_s / usual.steps as f64;
            let [.., shortest] = ROUND_S;
            let found = ROUND_S.into_iter().find(|step_s| *step_s <= longest_s);
            Ok(found.unwrap_or(shortest))
        }
    }
}

/// The position at the beginning of each step of `step_s` with these commands.
pub(super) fn respond(export: &ServoExport<'_>, step_s: f64, command: &[f64]) -> Vec<f64> {
    let servo = &export.parameters;
    let delay = DelayInSteps::new(servo.delay_s, step_s);
    let stepper = |part: f64| Stepper::new(servo, part * step_s);
    let (whole, before, after) = (
        stepper(1.0),
        stepper(delay.fraction),
        stepper(1.0 - delay.fraction),
    );
    let first = command.first().copied().unwrap_or(0.0);
    let mut state = State::at_rest(servo.resting_angle(first));
    let mut position = Vec::with_capacity(command.len());
    for k in 0..command.len() {
        position.push(state.output(servo));
        let (older, newer) = delay.late(command, k);
        if older == newer {
            whole.advance(&mut state, newer);
        } else {
            before.advance(&mut state, older);
            after.advance(&mut state, newer);
        }
    }
    position
}
