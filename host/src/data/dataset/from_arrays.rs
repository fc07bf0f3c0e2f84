//! Arrays of samples, as programs hand them over.

use super::about::About;
use super::error::DatasetError;
use super::from_tables::note_sentinel_value;
use super::loaded::{Loaded, late_by_polling, run};
use super::moving_command::unseen_within_rows;
use super::pulse_waits::note_common_wait;
use super::wrapped_angle;
use std::borrow::Cow;

/// Runs of one servo under one condition.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Arrays<'a> {
    /// What they are called in sentences.
    pub name: String,
    /// Time between samples \[s\].
    pub period_s: f64,
    /// From an edge of the input to the first sample that carries it \[s\].
    pub phase_s: f64,
    /// The runs.
    pub runs: Vec<ArrayRun<'a>>,
    /// Whether another clock polled the input, so that a change that is seen in a sample came up to one period before: half of that is added
    /// to the phase.
    pub polled: bool,
    /// Whether the servo was sent the input to its last digit and with its samples, so that steps and noise of it are meant, and no change waited for a pulse.
    pub exact_command: bool,
    /// The name or gain of the controller that drove each run, where several did; else empty.
    pub controllers: Vec<f64>,
    /// The unit of the input, where it is known.
    pub input_unit: Option<String>,
    /// The unit of the output, where it is known.
    pub output_unit: Option<String>,
}

/// One run: input and output, NaN where a sample is missing. Slices are not copied.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ArrayRun<'a> {
    /// The command.
    pub input: Cow<'a, [f64]>,
    /// The measured motion.
    pub output: Cow<'a, [f64]>,
    /// The input during at least the settling time before the run, where that is known.
    pub at_rest: Option<f64>,
}

impl<'a> Arrays<'a> {
    /// The same, with the samples copied.
    #[must_use]
    pub fn into_owned(self) -> Arrays<'static> {
        let runs = self.runs.into_iter().map(|run| ArrayRun {
            input: run.input.into_owned().into(),
            output: run.output.into_owned().into(),
            at_rest: run.at_rest,
        });
        Arrays {
            runs: runs.collect(),
            ..self
        }
    }

    pub(super) fn loaded(self) -> Result<Loaded<'a>, DatasetError> {
        let mut about = About {
            input_unit: self.input_unit,
            output_unit: self.output_unit,
            commands_at_rows: !self.polled,
            polled: self.polled,
            exact_command: self.exact_command,
            ..About::default()
        };
        let mut runs = Vec::new();
        for (arrays, number) in self.runs.into_iter().zip(1..) {
            let place = format!("run {number}");
            for (name, column) in [("input", &arrays.input), ("output", &arrays.output)] {
                note_sentinel_value(&mut about, &place, name, column);
            }
            let unit = about.output_unit.as_deref();
            let together = wrapped_angle::put_together("output", &arrays.output, unit);
            let output = match together {
                Some(angle) => {
                    about.add_change(format!("{place}: {}.", angle.remark), angle.jumps);
                    Cow::Owned(angle.column)
                }
                None => arrays.output,
            };
            let next = run(arrays.input, output, arrays.at_rest);
            let next = next.map_err(|error| DatasetError::Data(place, error))?;
            runs.push(match self.exact_command {
                true => next.with_exact_input(),
                false => next,
            });
        }
        let late_s = late_by_polling(self.polled, self.period_s);
        let unseen_s = match self.polled || self.exact_command {
            true => 0.0,
            false => unseen_within_rows(&runs, self.period_s, &mut about, ""),
        };
        about.sensor_delay_uncertainty_s = late_s + unseen_s;
        note_common_wait(&runs, self.period_s, &mut about);
        Ok(Loaded {
            runs,
            controllers: self.controllers,
            rest: Vec::new(),
            period_s: self.period_s,
            phase_s: self.phase_s + late_s,
            about,
        })
    }
}
