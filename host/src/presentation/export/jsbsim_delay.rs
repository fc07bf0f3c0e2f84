//! A delay in JSBSim, right to a part of a step: as the parts of a file, and as JSBSim computes them.
//!
//! An element `<delay>` has whole steps, and n of them delay by n-1. Tustin's rule, by which JSBSim replaces poles, takes a command of steps for one of
//! straight lines, which is early by half a step. Both are made up for by a mean of two neighbouring commands behind the element: the line between them.

use super::emulation::DelayLine;
use super::text::number;
use crate::presentation::template::fill;

/// By how many steps Tustin's rule is early.
const EARLY: f64 = 0.5;

/// The commands of which the parts make a mean: the newest, and those of this many steps less one.
const COMMANDS: usize = 4;

/// The parts that delay what an element `<delay type="time">` of the same delay passes on, from the property `input` to `fcs/ID-aligned`.
pub(super) fn aligned(id: &str, input: &str, delay_s: f64) -> String {
    let share = |back: usize| {
        let command = match back {
            0 => input.to_owned(),
            _ => format!("fcs/{id}-last-{back}"),
        };
        let values = [
            ("id", id.to_owned()),
            ("command", command),
            ("back", back.to_string()),
        ];
        fill(include_str!("templates/aligned_share.xml"), &values)
    };
    let shares: Vec<String> = (0..COMMANDS).map(share).collect();
    let values = [
        ("id", id.to_owned()),
        ("input", input.to_owned()),
        ("delay", number(delay_s)),
        ("shares", shares.join("\n")),
    ];
    fill(include_str!("templates/aligned.xml"), &values)
}

/// The element and the parts behind it, as JSBSim computes them.
#[derive(Clone, Debug)]
pub(super) struct DelayOfParts {
    element: DelayLine,
    /// The commands behind the element, the newest first.
    passed: [f64; COMMANDS],
    shares: [f64; COMMANDS],
}

impl DelayOfParts {
    /// In steps of this length, with `first` in all places.
    pub fn new(delay_s: f64, step_s: f64, first: f64) -> Self {
        let steps = delay_s / step_s;
        let whole = (steps as usize).saturating_sub(1);
        let left = EARLY + steps.min(1.0 + steps.fract());
        let share = |back: usize| (1.0 - (left - back as f64).abs()).max(0.0);
        Self {
            element: DelayLine::new(whole, first),
            passed: [first; COMMANDS],
            shares: std::array::from_fn(share),
        }
    }

    /// One in, one out.
    pub fn pass(&mut self, newest: f64) -> f64 {
        self.passed.rotate_right(1);
        self.passed[0] = self.element.pass(newest);
        let shares = self.passed.iter().zip(self.shares);
        shares.map(|(command, share)| share * command).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of a ramp, which a mean of two neighbours passes on as it is.
    #[test]
    fn a_delay_is_right_to_a_part_of_a_step() {
        for steps in [0.0, 0.3, 0.99, 1.0, 1.5, 2.0, 7.25] {
            let mut parts = DelayOfParts::new(steps * 0.002, 0.002, 0.0);
            let passed = (0..20).map(|step| parts.pass(f64::from(step))).last();
            let late = 19.0 - passed.unwrap();
            assert!((late - EARLY - steps).abs() < 1e-9, "{late} for {steps}");
        }
    }
}
