//! The sine that a header names, and how late a program is under it.

use super::subjects::{Exported, number_behind, prose};
use servoid_dynamics::{Grid, Start, simulate};
use std::f64::consts::TAU;

/// Periods that are compared; one comes before them.
const PERIODS: usize = 3;

/// Parts of a step, in which a pulse may begin.
const PARTS: usize = 25;

/// This part of a frame or of a step is rounding.
const ROUNDING: f64 = 1e-4;

/// The sine.
pub struct Smooth {
    middle: f64,
    amplitude: f64,
    /// Of a period.
    steps: usize,
    step_s: f64,
    frame_s: f64,
    stated_s: f64,
}

impl Smooth {
    /// As the header of this file names it, which was exported with this pulse frame.
    pub fn of(exported: &Exported, frame_s: f64) -> Self {
        let said = prose(&exported.text);
        let (_, said) = said.split_once("Smooth command: ").unwrap();
        let behind = |words: &str| number_behind(said, words);
        let hertz = behind(" deg at ");
        let early = said.contains("ms early.");
        let late_s = 1e-3 * behind(", the position is ");
        Self {
            middle: behind("under a sine of "),
            amplitude: behind(" +- "),
            steps: (1.0 / hertz / exported.trial.step_s).round() as usize,
            step_s: exported.trial.step_s,
            frame_s,
            stated_s: if early { -late_s } else { late_s },
        }
    }

    /// How late the header says that the file is; negative where it is early \[s\].
    pub fn stated_s(&self) -> f64 {
        self.stated_s
    }

    /// The command of each step, new in the first step of a frame of `frame_s`, 0 for none.
    pub fn command(&self, frame_s: f64) -> Vec<f64> {
        let command = |step: usize| {
            let time_s = step as f64 * self.step_s;
            match frame_s > 0.0 {
                true => self.of_pulse(time_s, frame_s),
                false => self.of_step(step as f64),
            }
        };
        (0..(1 + PERIODS) * self.steps).map(command).collect()
    }

    fn of_step(&self, step: f64) -> f64 {
        self.middle + self.amplitude * (TAU * step / self.steps as f64).sin()
    }

    /// What the last pulse before this time has: the command of the step in which it began.
    fn of_pulse(&self, time_s: f64, frame_s: f64) -> f64 {
        // A step of "8.333333" ms is a little short.
        let pulse_s = (time_s / frame_s + ROUNDING).floor() * frame_s;
        self.of_step((pulse_s / self.step_s + ROUNDING).floor())
    }

    /// The command as the servo has it, in parts of a step.
    fn in_parts(&self) -> Vec<f64> {
        let parts = (1 + PERIODS) * self.steps * PARTS;
        let at = |part: usize| match self.frame_s > 0.0 {
            true => self.of_pulse(part as f64 / PARTS as f64 * self.step_s, self.frame_s),
            false => self.of_step((part / PARTS) as f64),
        };
        (0..parts).map(at).collect()
    }

    /// Requires that these positions, at the beginning of each step, are as late as the header says.
    pub fn check(&self, exported: &Exported, positions: &[f64]) {
        let command = self.in_parts();
        let part_s = self.step_s / PARTS as f64;
        let grid = Grid::for_stiffness(part_s, 0.0, exported.servo.stiffness);
        let rest = exported.servo.resting_output(command[0]);
        let mut exact = Vec::new();
        let start = Start::at_rest(rest, Some(command[0]));
        simulate(&exported.servo, &grid, &start, &command, |_, y| {
            exact.push(y)
        });
        let exact: Vec<f64> = exact.into_iter().step_by(PARTS).collect();
        let late = (self.phase(positions) - self.phase(&exact)) / TAU;
        let late_s = (late - late.round()) * self.steps as f64 * self.step_s;
        // A tenth of a millisecond is written, and the frequency to 1 %, of a lag of some ms.
        let apart = (late_s - self.stated_s).abs();
        assert!(apart < 2e-4, "{late_s} for {}", self.stated_s);
    }

    fn phase(&self, positions: &[f64]) -> f64 {
        let compared = positions.iter().enumerate().skip(self.steps);
        let (sine, cosine) = compared.fold((0.0, 0.0), |(a, b), (step, position)| {
            let phase = TAU * step as f64 / self.steps as f64;
            (a + position * phase.sin(), b + position * phase.cos())
        });
        (-cosine).atan2(sine)
    }
}
