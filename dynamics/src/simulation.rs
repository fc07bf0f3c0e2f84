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
const FINENESS: f64 = 0.05;

/// Shortest and longest step \[s\].
const STEP_S: (f64, f64) = (0.2e-3, 5e-3);

impl Grid {
    /// The grid for a servo of the stiffness `stiffness` (1/s²).
    pub fn for_stiffness(period_s: f64, phase_s: f64, stiffness: f64) -> Self {
        let step_s = FINENESS / stiffness.sqrt();
        Self::new(period_s, phase_s, step_s.clamp(STEP_S.0, STEP_S.1))
    }

    /// With half as many steps, and four times the error.
    #[must_use]
    pub fn coarser(self) -> Self {
        Self {
            steps: self.steps.div_ceil(2),
            ..self
        }
    }

    /// Length of a step \[s\].
    fn step_s(&self) -> f64 {
        self.period_s / self.steps as f64
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
    let step = Stepper::new(physics, S::constant(grid.step_s()));
    let edge = DelayedEdge::new(physics, grid);
    let per_output = S::constant(1.0) / physics.gain;
    let mut state = State {
        angle: (start.output - physics.offset) * per_output,
        speed: start.rate * per_output,
    };
    // The sample of the input that acts after the edge in sample period `k`; none before the first one.
    let acting = |k: isize| -> Option<f64> {
        let index = usize::try_from(k - edge.periods).ok()?;
        input.get(index).or(input.last()).copied()
    };
    let mut held = acting(-1);
    let mut command = match (held, start.command_before) {
        (Some(first), _) => S::constant(first),
        (None, Some(before)) => before,
        (None, None) => physics.holding_command(state.angle),
    };
    for k in 0..input.len() {
        each(k, state.angle * physics.gain + physics.offset);
        for _ in 0..edge.step {
            step.advance(&mut state, command);
        }
        match acting(k as isize) {
            Some(new) if held != Some(new) => {
                edge.until.advance(&mut state, command);
                (held, command) = (Some(new), S::constant(new));
                edge.after.advance(&mut state, command);
            }
            _ => step.advance(&mut state, command),
        }
        for _ in edge.step + 1..grid.steps {
            step.advance(&mut state, command);
        }
    }
}

/// Where the delayed edge of the input falls: in every sample period at the same time.
struct DelayedEdge<S> {
    /// Whole sample periods between a sample of the input and the period in which it acts. Negative where the output is sampled
    /// after the edge, and the delay is shorter than that.
    periods: isize,
    /// The step of the integration that it falls into.
    step: usize,
    /// The part of that step before it. Its length is a variable like the others.
    until: Stepper<S>,
    /// The part after it.
    after: Stepper<S>,
}

impl<S: Scalar> DelayedEdge<S> {
    fn new(physics: &ServoParameters<S>, grid: &Grid) -> Self {
        let delay_s = physics.delay_s - S::constant(grid.phase_s);
        let periods = (delay_s.value() / grid.period_s).floor();
        let in_period_s = delay_s - S::constant(periods * grid.period_s);
        let step = (in_period_s.value() / grid.step_s()).floor();
        let step = step.min(grid.steps as f64 - 1.0);
        let until_s = in_period_s - S::constant(step * grid.step_s());
        Self {
            periods: periods as isize,
            step: step as usize,
            until: Stepper::new(physics, until_s),
            after: Stepper::new(physics, S::constant(grid.step_s()) - until_s),
        }
    }
}
