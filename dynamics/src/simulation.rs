//! The motion of the servo under a sampled command.

use crate::dual::Scalar;
use crate::equation::ServoParameters;
use crate::stepper::{State, Stepper};

/// When the output is sampled, and how finely the motion between samples is computed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid {
    /// Sample period \[s\].
    pub period_s: f64,
    /// Time from the edge of the input to the sample of the output that belongs to it \[s\].
    pub phase_s: f64,
    /// Steps of the integration in a sample period.
    pub steps: usize,
}

/// Length of a step times the bandwidth ω at small signals: the scheme is of second order, so the motion is right to about a
/// ten-thousandth of the stroke, well below the noise of any sensor.
const FINENESS: f64 = 0.03;

/// Shortest and longest step \[s\].
const STEP_S: (f64, f64) = (0.2e-3, 2e-3);

impl Grid {
    /// The grid for a servo of the stiffness `stiffness` (1/s²).
    pub fn for_stiffness(period_s: f64, phase_s: f64, stiffness: f64) -> Self {
        let step_s = FINENESS / stiffness.sqrt();
        Self::new(period_s, phase_s, step_s.clamp(STEP_S.0, STEP_S.1))
    }

    /// A grid with steps of at most `longest_step_s`.
    pub fn new(period_s: f64, phase_s: f64, longest_step_s: f64) -> Self {
        // A period that is a whole number of steps but for rounding does not get one more.
        let steps = (period_s / longest_step_s - 1e-9).ceil().max(1.0) as usize;
        Self {
            period_s,
            phase_s,
            steps,
        }
    }
}

/// The state of the servo at its first sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Start<S> {
    /// The output.
    pub output: S,
    /// Its rate of change (1/s).
    pub rate: S,
    /// The command before the first sample; `None` for the one that holds the servo where it is.
    pub command_before: Option<S>,
}

impl Start<f64> {
    /// At rest at `output`, under the command `command_before`.
    pub fn at_rest(output: f64, command_before: Option<f64>) -> Self {
        Self {
            output,
            rate: 0.0,
            command_before,
        }
    }

    /// The same without derivatives.
    pub fn lifted<S: Scalar>(&self) -> Start<S> {
        Start {
            output: S::constant(self.output),
            rate: S::constant(self.rate),
            command_before: self.command_before.map(S::constant),
        }
    }
}

/// Simulates the output under `input`, and hands each of its samples to `each`.
///
/// The input is held between samples. A step of the integration ends where the delayed input changes, so the output
/// is a smooth function of the delay, also where the drive is full at once.
pub fn simulate<S: Scalar>(
    physics: &ServoParameters<S>,
    grid: &Grid,
    start: &Start<S>,
    input: &[f64],
    mut each: impl FnMut(usize, S),
) {
    let step_s = grid.period_s / grid.steps as f64;
    let stepper = Stepper::new(physics, S::constant(step_s));
    let per_output = S::constant(1.0) / physics.gain;
    let mut state = State {
        angle: (start.output - physics.offset) * per_output,
        speed: start.rate * per_output,
    };
    let before = start
        .command_before
        .unwrap_or_else(|| physics.holding_command(state.angle));
    let sample = |k: f64| match k < 0.0 {
        true => before,
        false => S::constant(input[(k as usize).min(input.len() - 1)]),
    };
    let changes = |k: f64| {
        let k = k as usize;
        k == 0 || k < input.len() && input[k] != input[k - 1]
    };
    let delay_s = physics.delay_s - S::constant(grid.phase_s);
    for k in 0..input.len() {
        each(k, state.angle * physics.gain + physics.offset);
        for step in 0..grid.steps {
            let at_s = k as f64 * grid.period_s + step as f64 * step_s;
            let from = (at_s - delay_s.value()) / grid.period_s;
            let (old, new) = (from.floor(), (from + step_s / grid.period_s).floor());
            if old == new || new < 0.0 || !changes(new) {
                stepper.advance(&mut state, sample(new));
                continue;
            }
            // The delayed edge falls into this step: its time is a variable like the others.
            let until_edge_s = delay_s + S::constant(new * grid.period_s - at_s);
            let after_edge_s = S::constant(step_s) - until_edge_s;
            Stepper::new(physics, until_edge_s).advance(&mut state, sample(new - 1.0));
            Stepper::new(physics, after_edge_s).advance(&mut state, sample(new));
        }
    }
}
