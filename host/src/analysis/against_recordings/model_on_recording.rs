//! The models of a file with the recording that they are held against.

use super::beside_pulses::rms_beside_pulses;
use super::misfit::{Line, Misfit};
use super::pulse_search::closest_pulses;
use super::pulses::StatedPulses;
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
            let model = &servo.model;
            anyhow::Ok(ServoOnRecording { model, controllers })
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
        let predict = |run: Run<'d>, number: usize| match &self.servo {
            Some(servo) => {
                let record = self.record.try_with_runs(vec![run]).ok()?;
                let controller = servo.controllers.get(number..=number);
                let runs = (servo.model).simulate(&record, controller.unwrap_or_default());
                runs.into_iter().next()
            }
            None => Some(self.linear.simulate(&run)),
        };
        let found = closest_pulses(&self.record, frame_s, &predict).with_context(|| {
            "the model can be held against none of the runs, so that no pulses are found: a validation without --frame-ms says why"
        })?;
        let record = found.held(&self.record)?;
        let beside = rms_beside_pulses(&self.record, &found, &predict).unwrap_or_default();
        let pulses = StatedPulses::of(found, frame_s, &self.record, beside);
        Ok(Self {
            record: Cow::Owned(record),
            pulses: Some(pulses),
            ..self
        })
    }

    pub(super) fn of_linear(&self) -> Result<Validation, Error> {
        self.linear.validate(&self.record)
    }

    pub(super) fn of_servo(&self) -> Result<Option<Validation>, Error> {
        let servo = self.servo.as_ref();
        let found = servo.map(|servo| servo.model.validate(&self.record, &servo.controllers));
        found.transpose()
    }

    /// What the recording has that the linear model has not.
    pub(super) fn misfit_of_linear(&self) -> Misfit {
        let runs = self.record.runs();
        let simulated: Vec<_> = runs.iter().map(|run| self.linear.simulate(run)).collect();
        Misfit::of(runs, &|_| simulated.clone(), self.record.sample_period_s())
    }

    /// The same of the servo model.
    pub(super) fn misfit_of_servo(&self, servo: &ServoOnRecording) -> Misfit {
        let simulate = |line: Line| {
            servo
                .model
                .simulate(&line.undone(&self.record), &servo.controllers)
        };
        Misfit::of(self.record.runs(), &simulate, self.record.sample_period_s())
    }

    /// What was measured in each run, and what the models predict; the linear one where it `has_linear`.
    pub(super) fn predictions(&self, has_linear: bool) -> Vec<PredictedRun> {
        let servo = self.servo.as_ref();
        let by_servo = servo.map(|servo| servo.model.simulate(&self.record, &servo.controllers));
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
