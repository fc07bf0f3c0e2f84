//! A model against recordings that it was not identified from.

use crate::data::dataset::Dataset;
use crate::data::fingerprint;
use crate::data::model_file::ModelFile;
use crate::data::model_metadata::ModelMetadata;
use anyhow::{Context, Result};
use serde::Serialize;
use servoid_identification::results::{Advice, Validation};

/// The validation as its document has it, with advice on the files.
#[derive(Debug, Serialize)]
pub struct Validated {
    /// That of the linear model.
    #[serde(flatten)]
    pub validation: Validation,
    /// The same of the servo model, where the file has one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub servo_model: Option<Validation>,
    /// That the model comes from these very samples, and what the files ask for.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub advice: Vec<Advice>,
}

impl Validated {
    /// Validates the model of `file`, which is called `model`, on the data, which are called `name`.
    ///
    /// # Errors
    /// Different units or sample periods, a controller that the model does not know, and data without the history that it
    /// needs.
    pub fn of(file: &ModelFile, model: &str, data: &Dataset, name: &str) -> Result<Self> {
        let servo = file.servo_model()?;
        let metadata = ModelMetadata::from(&data.about);
        file.metadata.same_units(model, &metadata, name)?;
        let validation = file.model.validate(&data.record);
        let validation = validation.with_context(|| name.to_owned())?;
        let servo = servo.map(|servo| -> Result<Validation> {
            let controllers = data.controllers.among(&servo.controller_names)?;
            Ok(servo.model.validate(&data.record, &controllers)?)
        });
        let own = fingerprint::of(&data.record);
        let own = fingerprint::advice_on_validation(&file.fingerprints, &own);
        Ok(Self {
            validation,
            servo_model: servo.transpose()?,
            advice: own.into_iter().chain(data.about.advice.clone()).collect(),
        })
    }
}
