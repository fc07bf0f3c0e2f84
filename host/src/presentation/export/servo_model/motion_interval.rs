//! How far the servo itself may be from its model, in units of the position: an interval of a motion, beside those of the quantities.

use super::subject::ServoExport;
use super::trial_command::{Trial, root_mean_square};
use crate::presentation::summary::{digits, percent};
use servoid_identification::results::{Bounds, six_digits};

/// Parts of the recorded range over which strokes go: larger ones may be beyond what the recording shows.
const PARTS: [f64; 4] = [1.0, 0.75, 0.5, 0.25];

/// Digits of what is stated.
const DIGITS: usize = 3;

impl ServoExport<'_> {
    /// The widest interval of the position and its root mean square, under the staircase of strokes over the recorded range; `None` where the model has no
    /// intervals at all, which a warning says.
    pub(super) fn motion_interval(&self) -> Option<String> {
        let level = percent(self.model.covariance.valid()?.level);
        let step_s = self.model.sample_period_s;
        let any = [f64::NEG_INFINITY, f64::INFINITY];
        let whole = Trial::of(self, step_s, any).only_staircase();
        let bounds_under = |trial: &Trial| {
            let response = self.model.respond(&trial.command(), self.controller);
            response.half_width
        };
        let smaller = PARTS.iter().map(|part| whole.enlarged(*part));
        let mut answered = smaller.map(|trial| (bounds_under(&trial), trial));
        let shown = answered.find(|(half_width, _)| half_width.valid().is_some());
        let (half_width, trial) = shown.unwrap_or_else(|| (bounds_under(&whole), whole.clone()));
        let levels = trial
            .levels
            .iter()
            .map(|level| six_digits(*level).to_string());
        let levels: Vec<String> = levels.collect();
        let seconds = |steps: usize| digits(steps as f64 * step_s, DIGITS);
        let strokes = format!(
            "under the commands {} {}, held for {} s each and then again for {} s each",
            levels.join(", "),
            self.command_unit(),
            seconds(trial.steps_per_level),
            seconds(trial.steps_of_broken_off)
        );
        Some(match half_width {
            Bounds::Valid(half_width) => {
                let widest = half_width.iter().copied().fold(0.0, f64::max);
                let rms = root_mean_square(&half_width, &vec![0.0; half_width.len()], 0);
                format!(
                    "Error of this servo model beside the servo that was recorded: up to {} {unit} at the moment where it is known least, and up to {} {unit} rms, {strokes}; with {level} % confidence at each moment, and wide where a quantity is open. The largest \
                     difference of this file (below), the noise of the sensor and another delay of another recording are not in it.",
                    digits(widest, DIGITS),
                    digits(rms, DIGITS),
                    unit = self.output_unit(),
                )
            }
            Bounds::Withdrawn(reason) => format!(
                "Error of this servo model beside the servo that was recorded: not known {strokes}, because {}.",
                reason.because()
            ),
        })
    }
}
