//! How a simulation begins.

use crate::dual::Scalar;
use crate::equation::ServoParameters;
use crate::stepper::State;

/// The state of the servo at its first sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Start<S> {
    /// The output.
    pub output: S,
    /// Its rate of change (1/s).
    pub rate: S,
    /// The command before the first sample; `None` for the one that holds the servo where it is.
    pub command_before: Option<S>,
    /// Where the shaft is in its play: how far the angle is ahead of the one that the output shows, over half the play, from -1 to 1.
    pub in_play: f64,
}

impl Start<f64> {
    /// At rest at `output`, under the command `command_before`, in the middle of the play.
    pub fn at_rest(output: f64, command_before: Option<f64>) -> Self {
        Self {
            output,
            rate: 0.0,
            command_before,
            in_play: 0.0,
        }
    }
}

impl<S: Scalar> ServoParameters<S> {
    /// The state in which a simulation begins.
    #[must_use]
    pub fn state_at(&self, start: &Start<S>) -> State<S> {
        let per_output = S::constant(1.0) / self.gain;
        let shown = (start.output - self.offset) * per_output;
        State {
            angle: shown + self.half_play() * start.in_play,
            speed: start.rate * per_output,
            shown,
        }
    }
}
