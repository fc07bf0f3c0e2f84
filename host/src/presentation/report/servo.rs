//! One servo under one condition, with all that a page shows of it.

use super::content::{Facts, Part};
use crate::data::HeldOutPrediction;
use crate::data::dataset::Dataset;
use crate::data::model_file::{ModelFile, ModelFileError, ServoModelDocument};
use crate::data::model_metadata::ModelMetadata;
use crate::presentation::plots::Subject;
use servoid_identification::diagnostics::Explanation;
use servoid_identification::flight_model::FlightModel;
use servoid_identification::results::Model;
use servoid_identification::{Identification, Options, Record, Run, Settling, identify};

/// A servo under one condition.
#[derive(Debug)]
pub struct Servo {
    /// Its name.
    pub name: String,
    /// Its model.
    pub model: Model,
    /// The choice of its structure; not known of a model from a file.
    pub explanation: Option<Explanation>,
    /// The data of its identification; not known of a model from a file.
    pub data: Option<Dataset<'static>>,
    /// The servo as a machine, where that was found.
    pub servo_model: Option<ServoModelDocument>,
    /// The low-order model, where the response is known in a band alone.
    pub low_order: Option<FlightModel>,
    /// A stretch that the models had not seen, where both were identified without one.
    pub held_out: Option<HeldOutPrediction>,
    /// Units, and the hold of the command.
    pub metadata: ModelMetadata,
    runs: Vec<Model>,
}

impl Servo {
    /// A model without its data.
    #[must_use]
    pub fn of_model(name: String, model: Model, metadata: ModelMetadata) -> Self {
        Self {
            name,
            model,
            explanation: None,
            data: None,
            servo_model: None,
            low_order: None,
            held_out: None,
            metadata,
            runs: Vec::new(),
        }
    }

    /// The models of a file.
    ///
    /// # Errors
    /// The servo model or the low-order model in it cannot be read.
    pub fn of_file(name: String, file: &ModelFile) -> Result<Self, ModelFileError> {
        let in_band = file.model.band().is_some();
        Ok(Self {
            servo_model: file.servo_model()?,
            low_order: file.flight_model()?.filter(|_| in_band),
            ..Self::of_model(name, file.model.clone(), file.metadata.clone())
        })
    }

    /// The identification of `data`; its runs are identified one by one as well.
    #[must_use]
    pub fn of_data(name: String, data: Dataset<'static>, found: Identification) -> Self {
        Self {
            name,
            runs: runs_alone(&data.record, &found.model).unwrap_or_default(),
            model: found.model,
            explanation: Some(found.explanation),
            metadata: ModelMetadata::from(&data.about),
            data: Some(data),
            servo_model: None,
            low_order: None,
            held_out: None,
        }
    }

    /// As a page shows it.
    #[must_use]
    pub fn part(&self) -> Part<'_> {
        let data = self.data.as_ref();
        Part {
            subject: Subject {
                name: &self.name,
                model: &self.model,
                record: data.map(|data| &data.record),
                units: self.metadata.units(),
            },
            explanation: self.explanation.as_ref(),
            runs: &self.runs,
            servo_model: self.servo_model.as_ref(),
            low_order: self.low_order.as_ref(),
            held_out: self.held_out.as_ref(),
            staircase: data.is_some_and(|data| data.about.staircase),
            metadata: &self.metadata,
            provenance: data.map_or(&[][..], |data: &Dataset| -> &[Facts] {
                &data.about.provenance
            }),
        }
    }
}

/// Most runs that are identified one by one.
const MOST_RUNS_ALONE: usize = 10;

/// Each run identified on its own, with the common settling time. `None` where there is one run, or one is too
/// short for a model.
fn runs_alone(record: &Record, model: &Model) -> Option<Vec<Model>> {
    let runs = record.runs();
    let default = Options::default();
    let options = Options {
        settling: Settling::Samples(model.structure.settling_samples),
        level: model.level().into_valid().unwrap_or(default.level),
        ..default
    };
    let alone = |run: &Run| {
        let record = Record::new(record.sample_period_s(), vec![run.clone()]).ok()?;
        identify(&record.with_sample_phase(model.sample_phase_s), &options).ok()
    };
    let several = (2..=MOST_RUNS_ALONE).contains(&runs.len());
    several.then(|| runs.iter().map(alone).collect())?
}
