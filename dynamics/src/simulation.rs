//! The motion of the servo under a sampled command.

use crate::commands::Commands;
use crate::dual::Scalar;
use crate::equation::{PulseEnd, ServoParameters, Slopes};
use crate::sloped_stepper::{SlopedCommand, SlopedState, SlopedStepper};
use crate::start::Start;
use crate::stepper::{Advance, Stepper};

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

/// Length of a step times the bandwidth ω at small signals: the scheme is of second order, beside friction, too, so the motion is right to about a
/// hundred-thousandth of the stroke, well below the noise of any sensor.
const FINENESS: f64 = 0.05;

/// A servo rests where its speed comes to this share of the range of the command in the time 1/ω, and its acceleration in 1/ω²: so far from its end it is then, but
/// for a factor that grows with its damping, far below the error of the integration. In recordings with holds, a servo rests for most of the time.
const STILL: f64 = 1e-6;

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

/// Simulates the output under `input`, and hands each of its samples to `each`.
///
/// The input is held between samples, unless [`Commands`] say that it changes within a period. A step of the integration ends where the delayed input changes, so the output
/// is a smooth function of the delay, also where the drive is full at once.
pub fn simulate<'a, S: Scalar>(
    physics: &ServoParameters<S>,
    grid: &Grid,
    start: &Start<S>,
    input: impl Into<Commands<'a>>,
    mut each: impl FnMut(usize, S),
) {
    let whole_s = S::constant(grid.step_s());
    let edge_of = |later_s: f64| {
        let place = DelayedEdge::new(physics.delay_s + S::constant(later_s), grid);
        Edge {
            periods: place.periods,
            step: place.step,
            until: Stepper::new(physics, place.until_s),
            after: Stepper::new(physics, whole_s - place.until_s),
        }
    };
    let period = Period {
        sample_s: grid.period_s,
        bandwidth: physics.stiffness.value().sqrt(),
        steps: grid.steps,
        whole: Stepper::new(physics, whole_s),
        edges: Edges::new(physics.pulse_end, edge_of),
    };
    let state = physics.state_at(start);
    let before = (start.command_before).unwrap_or_else(|| physics.holding_command(state.angle));
    period.repeat(state, before, input.into(), |k, state| {
        each(k, state.output(physics));
    });
}

/// [`simulate`] with the derivatives of each sample by the parameters, in the order of [`ServoParameters::in_order`], and by the zero of the
/// sensor: that by the offset of a servo whose stops [move](crate::Stops::seen_from) with it.
///
/// They are those of [`Dual`](crate::Dual) numbers, several times as fast.
pub fn simulate_with_slopes<'a>(
    physics: &ServoParameters<f64>,
    grid: &Grid,
    start: &Start<f64>,
    input: impl Into<Commands<'a>>,
    mut each: impl FnMut(usize, f64, &Slopes, f64),
) {
    let whole_s = grid.step_s();
    let edge_of = |later_s: f64| {
        let place = DelayedEdge::new(physics.delay_s + later_s, grid);
        Edge {
            periods: place.periods,
            step: place.step,
            until: SlopedStepper::new(physics, place.until_s, 1.0),
            after: SlopedStepper::new(physics, whole_s - place.until_s, -1.0),
        }
    };
    let period = Period {
        sample_s: grid.period_s,
        bandwidth: physics.stiffness.sqrt(),
        steps: grid.steps,
        whole: SlopedStepper::new(physics, whole_s, 0.0),
        edges: Edges::new(physics.pulse_end, edge_of),
    };
    let state = SlopedState::new(physics, start);
    let held = state.holding_command(physics);
    let before = match start.command_before {
        Some(command) => SlopedStepper::command(command),
        None => SlopedCommand {
            value: held.0,
            slopes: Some(&held.1),
        },
    };
    period.repeat(state, before, input.into(), |k, state| {
        let (output, slopes, by_zero) = state.output(physics);
        each(k, output, &slopes, by_zero);
    });
}

/// Where a change of the delayed input falls, and the step of the integration that it parts.
struct Edge<A> {
    /// Whole sample periods between the sample of the input and the period in which it acts. Negative where the output is sampled
    /// after the edge, and the delay is shorter than that.
    periods: isize,
    /// The step of the integration that it falls into.
    step: usize,
    /// The part of that step before it.
    until: A,
    /// The part after it.
    after: A,
}

/// The edges of all commands.
struct Edges<A, F> {
    /// That of every command, or of the neutral one where `pulse_end` makes others differ.
    of_neutral: Edge<A>,
    pulse_end: Option<PulseEnd>,
    /// The edge of a command that acts so many seconds later.
    later: F,
}

impl<A, F: Fn(f64) -> Edge<A>> Edges<A, F> {
    fn new(pulse_end: Option<PulseEnd>, later: F) -> Self {
        Self {
            of_neutral: later(0.0),
            pulse_end,
            later,
        }
    }

    /// The edge of `command`, which comes into force so much after its sample as `late_s` says. Where it has one of its own, that is kept in `own`, until it acts.
    #[inline(always)]
    fn of<'a>(
        &'a self,
        command: f64,
        late_s: Option<f64>,
        own: &'a mut Option<Edge<A>>,
    ) -> &'a Edge<A> {
        let of_pulse = self.pulse_end.map(|end| end.later_s(command));
        match (of_pulse, late_s) {
            (None, None) => &self.of_neutral,
            (a, b) => own
                .get_or_insert_with(|| (self.later)(a.unwrap_or_default() + b.unwrap_or_default())),
        }
    }
}

/// A sample period, in which the delayed input may change.
struct Period<A, F> {
    /// Its length \[s\].
    sample_s: f64,
    /// ω of the servo at small signals \[rad/s\].
    bandwidth: f64,
    /// Steps of the integration.
    steps: usize,
    /// One of them.
    whole: A,
    edges: Edges<A, F>,
}

impl<A: Advance, F: Fn(f64) -> Edge<A>> Period<A, F> {
    /// Moves `state` through all of `input`, and hands it to `each` at each sample. The command is `before` until the first sample
    /// of the input acts. Of two that fall into one step of the integration, which pulses do not, the second acts at its end.
    #[inline(always)]
    fn repeat(
        &self,
        mut state: A::State,
        before: A::Command,
        Commands {
            levels: input,
            late_s,
        }: Commands<'_>,
        mut each: impl FnMut(usize, &A::State),
    ) {
        let still = STILL * range(input);
        let (mut held, mut command) = (None, before);
        let mut inputs = input.iter().copied().enumerate().peekable();
        let (mut own, mut rests) = (None, false);
        for k in 0..input.len() {
            each(k, &state);
            let speed = A::speed(&state);
            let (mut step, mut is_new) = (0, false);
            loop {
                while inputs.next_if(|(_, same)| held == Some(*same)).is_some() {}
                let Some(&(index, new)) = inputs.peek() else {
                    break;
                };
                let late_s = late_s.map(|late_s| late_s[index]);
                let edge = self.edges.of(new, late_s, &mut own);
                let from_period = index as isize + edge.periods - k as isize;
                if from_period > 0 {
                    break;
                }
                if from_period == 0 && edge.step >= step {
                    for _ in step..edge.step {
                        self.whole.advance(&mut state, command);
                    }
                    edge.until.advance(&mut state, command);
                    edge.after.advance(&mut state, A::command(new));
                    step = edge.step + 1;
                }
                (held, command, is_new) = (Some(new), A::command(new), true);
                own = None;
            }
            if rests && !is_new {
                continue;
            }
            for _ in step..self.steps {
                self.whole.advance(&mut state, command);
            }
            rests = !is_new && self.is_still([speed, A::speed(&state)], still);
        }
    }

    /// Whether the speeds at both ends of this period leave the servo within `still` of where it is.
    #[inline(always)]
    fn is_still(&self, [before, after]: [f64; 2], still: f64) -> bool {
        let lag_s = 1.0 / self.bandwidth;
        let acceleration = (after - before) / self.sample_s;
        after.abs() * lag_s < still && acceleration.abs() * lag_s * lag_s < still
    }
}

/// What the largest of `input` is above the least.
fn range(input: &[f64]) -> f64 {
    let [least, largest] = (input.iter()).fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], u| {
        [a.min(*u), b.max(*u)]
    });
    largest - least
}

/// Where the delayed edge of the input falls: in every sample period at the same time.
struct DelayedEdge<S> {
    /// Whole sample periods of the delay.
    periods: isize,
    /// The step of the integration that it falls into.
    step: usize,
    /// The part of that step before it \[s\]. Its length is a variable like the others.
    until_s: S,
}

impl<S: Scalar> DelayedEdge<S> {
    fn new(delay_s: S, grid: &Grid) -> Self {
        let delay_s = delay_s - S::constant(grid.phase_s);
        let periods = (delay_s.value() / grid.period_s).floor();
        let in_period_s = delay_s - S::constant(periods * grid.period_s);
        let step = (in_period_s.value() / grid.step_s()).floor();
        let step = step.min(grid.steps as f64 - 1.0);
        Self {
            periods: periods as isize,
            step: step as usize,
            until_s: in_period_s - S::constant(step * grid.step_s()),
        }
    }
}

#[cfg(test)]
mod tests;
