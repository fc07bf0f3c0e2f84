//! The models of a file with the recording that they are held against.

use super::beside_pulses::rms_beside_pulses;
use super::misfit::{Line, Misfit};
use super::pulses::{By, StatedPulses};
use crate::analysis::command_times::pulse_errors::{simulate_with_pulses, with_pulses};
use crate::analysis::command_times::pulse_search::{ClosestPulses, Lengths, closest_pulses};
use crate::data::PredictedRun;
use crate::data::dataset::Dataset;
use crate::data::model_file::{ModelFile, ServoModelDocument};
use anyhow::{Context, Result};
use servoid_identification::results::{Model, Validation};
use servoid_identification::servo_model::ServoModel;
use servoid_identification::{Error, Record, Run};
use std::borrow::Cow;

/// The servo model of a file, with the place of each run's controller among its own.
pub(super) struct ServoOnRecording<'d> {
    pub(super) model: &'d ServoModel,
    controllers: Vec<usize>,
    /// The recording with its commands at their pulses, where these are stated.
    at_pulses: Option<Record<'d>>,
}

impl ServoOnRecording<'_> {
    /// The output of each run of the `record`, as a model has it that differs by `line`.
    fn simulate(&self, record: &Record, line: Option<Line>) -> Vec<Vec<f64>> {
        let record = self.at_pulses.as_ref().unwrap_or(record);
        match line {
            Some(line) => (self.model).simulate(&line.undone(record), &self.controllers),
            None => self.model.simulate(record, &self.controllers),
        }
    }

    /// That of one run of `record`, which has this number, with such pulses \[rows\].
    fn simulate_run(
        &self,
        record: &Record,
        (run, number): (&Run, usize),
        pulses: [f64; 2],
    ) -> Option<Vec<f64>> {
        let controller = self.controllers.get(number..=number).unwrap_or_default();
        simulate_with_pulses(self.model, controller, record, run, pulses)
    }
}

/// The models of a file and a recording.
pub(super) struct ModelOnRecording<'d> {
    pub(super) linear: &'d Model,
    pub(super) servo: Option<ServoOnRecording<'d>>,
    pub(super) record: Cow<'d, Record<'d>>,
    /// The pulses that commands are taken to wait for.
    pub(super) pulses: Option<StatedPulses>,
}

impl<'d> ModelOnRecording<'d> {
    /// The commands of the data act as they are recorded.
    ///
    /// # Errors
    /// A controller that the servo model does not know.
    pub(super) fn of(
        file: &'d ModelFile,
        servo: Option<&'d ServoModelDocument>,
        data: &'d Dataset,
    ) -> Result<Self> {
        let servo = servo.map(|servo| {
            let controllers = data.controllers.among(&servo.controller_names)?;
            anyhow::Ok(ServoOnRecording {
                model: &servo.model,
                controllers,
                at_pulses: None,
            })
        });
        Ok(Self {
            linear: &file.model,
            servo: servo.transpose()?,
            record: Cow::Borrowed(&data.record),
            pulses: None,
        })
    }

    /// The same with commands at pulses about every `frame_s`, where the servo model, or the linear one of a file without one, is closest.
    ///
    /// # Errors
    /// The model cannot be held against any run.
    pub(super) fn at_pulses(self, frame_s: f64) -> Result<Self> {
        let found = self.closest(frame_s)?;
        let held = found.held(&self.record)?;
        Ok(Self {
            record: Cow::Owned(held),
            ..self.with_servo_at(found, (frame_s, By::Statement))?
        })
    }

    /// The same for the servo model alone, which has the commands of its own recording at such pulses: the linear one has the waits in its times. As recorded, where the model is closer so: not all commands wait.
    ///
    /// # Errors
    /// The model cannot be held against any run.
    pub(super) fn servo_at_pulses(self, frame_s: f64) -> Result<Self> {
        let found = self.closest(frame_s)?;
        let as_recorded = self.of_servo()?;
        match as_recorded.is_some_and(|as_recorded| as_recorded.rmse <= found.rmse) {
            true => Ok(self),
            false => self.with_servo_at(found, (frame_s, By::OwnRecording)),
        }
    }

    fn closest(&self, frame_s: f64) -> Result<ClosestPulses> {
        closest_pulses(&self.record, (frame_s, Lengths::StatedFirst), &self.predict()).with_context(|| {
            "the model can be held against none of the runs, so that no pulses are found: a validation without --frame-ms says why"
        })
    }

    fn predict(&self) -> impl Fn(&Run<'d>, usize, [f64; 2]) -> Option<Vec<f64>> {
        let as_rows = |pulses: [f64; 2]| pulses.map(|s| s / self.record.sample_period_s());
        move |run, number, pulses| match &self.servo {
            Some(servo) => servo.simulate_run(&self.record, (run, number), as_rows(pulses)),
            None => Some(self.linear.simulate(&with_pulses(run, as_rows(pulses))?)),
        }
    }

    fn with_servo_at(self, found: ClosestPulses, frame: (f64, By)) -> Result<Self> {
        let beside = rms_beside_pulses(&self.record, &found, &self.predict()).unwrap_or_default();
        let in_force = found.in_force(&self.record)?;
        let pulses = StatedPulses::of(found, frame, &self.record, beside);
        let servo = self.servo.map(|servo| ServoOnRecording {
            at_pulses: Some(in_force),
            ..servo
        });
        Ok(Self {
            servo,
            pulses: Some(pulses),
            ..self
        })
    }

    pub(super) fn of_linear(&self) -> Result<Validation, Error> {
        self.linear.validate(&self.record)
    }

    pub(super) fn of_servo(&self) -> Result<Option<Validation>, Error> {
        let validated = |servo: &ServoOnRecording| {
            let simulated = servo.simulate(&self.record, None).into_iter().flatten();
            Validation::of_pairs(self.record.outputs().zip(simulated))
                .ok_or(Error::NoHistory { history: 1 })
        };
        self.servo.as_ref().map(validated).transpose()
    }

    /// What the recording has that the linear model has not.
    pub(super) fn misfit_of_linear(&self) -> Misfit {
        let runs = self.record.runs();
        let simulated: Vec<_> = runs.iter().map(|run| self.linear.simulate(run)).collect();
        Misfit::of(runs, &|_| simulated.clone(), self.record.sample_period_s())
    }

    /// The same of the servo model.
    pub(super) fn misfit_of_servo(&self, servo: &ServoOnRecording) -> Misfit {
        let simulate = |line: Line| servo.simulate(&self.record, Some(line));
        Misfit::of(self.record.runs(), &simulate, self.record.sample_period_s())
    }

    /// What was measured in each run, and what the models predict; the linear one where it `has_linear`.
    pub(super) fn predictions(&self, has_linear: bool) -> Vec<PredictedRun> {
        let servo = self.servo.as_ref();
        let by_servo = servo.map(|servo| servo.simulate(&self.record, None));
        let mut by_servo = by_servo.into_iter().flatten();
        let of_run = |run: &Run| PredictedRun {
            period_s: self.record.sample_period_s(),
            measured: run.output().to_vec(),
            by_linear: has_linear.then(|| self.linear.simulate(run)),
            by_servo: by_servo.next(),
        };
        self.record.runs().iter().map(of_run).collect()
    }
}
