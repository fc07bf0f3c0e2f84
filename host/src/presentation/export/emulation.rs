//! Parts that the servos of other programs are made of, as those programs compute them.

/// A line of commands: what goes in comes out some steps later.
#[derive(Clone, Debug)]
pub(super) struct DelayLine {
    /// The newest last.
    past: std::collections::VecDeque<f64>,
}

impl DelayLine {
    /// Later by `steps` steps, with `first` in all places.
    pub fn new(steps: usize, first: f64) -> Self {
        Self {
            past: std::iter::repeat_n(first, steps).collect(),
        }
    }

    /// One in, one out.
    pub fn pass(&mut self, newest: f64) -> f64 {
        self.past.push_back(newest);
        self.past.pop_front().unwrap_or(newest)
    }
}

/// 1/(1 + Ts) by Tustin's rule, at rest at 0.
#[derive(Clone, Copy, Debug)]
pub(super) struct FirstOrder {
    input: f64,
    output: f64,
    last_input: f64,
    last_output: f64,
}

impl FirstOrder {
    /// With the time constant T \[s\].
    pub fn new(lag_s: f64, step_s: f64) -> Self {
        let steps = step_s / lag_s;
        Self {
            input: steps / (2.0 + steps),
            output: (2.0 - steps) / (2.0 + steps),
            last_input: 0.0,
            last_output: 0.0,
        }
    }

    /// One step.
    pub fn pass(&mut self, newest: f64) -> f64 {
        self.last_output = self.input * (newest + self.last_input) + self.output * self.last_output;
        self.last_input = newest;
        self.last_output
    }
}

/// ω²/(s² + 2ζω s + ω²) by Tustin's rule.
#[derive(Clone, Copy, Debug)]
pub(super) struct SecondOrder {
    input: [f64; 3],
    output: [f64; 2],
    inputs: [f64; 2],
    outputs: [f64; 2],
}

impl SecondOrder {
    /// With the stiffness ω² (1/s²) and the damping 2ζω (1/s), at rest at `first`.
    pub fn new(stiffness: f64, damping: f64, step_s: f64, first: f64) -> Self {
        let (square, double) = (stiffness * step_s * step_s, 2.0 * damping * step_s);
        let sum = 4.0 + double + square;
        let through = square / sum;
        Self {
            input: [through, 2.0 * through, through],
            output: [(2.0 * square - 8.0) / sum, (4.0 - double + square) / sum],
            inputs: [first; 2],
            outputs: [first; 2],
        }
    }

    /// One step.
    pub fn pass(&mut self, newest: f64) -> f64 {
        let ([a, b, c], [d, e]) = (self.input, self.output);
        let ([u1, u2], [y1, y2]) = (self.inputs, self.outputs);
        let output = a * newest + b * u1 + c * u2 - d * y1 - e * y2;
        self.inputs = [newest, u1];
        self.outputs = [output, y1];
        output
    }
}
