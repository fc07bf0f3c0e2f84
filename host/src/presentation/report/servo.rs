//! One servo, read and identified: what a page says of it, owned.

use super::content::Part;
use super::runs_alone::runs_alone;
use crate::data::dataset::Dataset;
use crate::data::model_metadata::ModelMetadata;
use crate::presentation::plots::paper_figures::Subject;
use servoid_identification::Identification;
use servoid_identification::diagnostics::Explanation;
use servoid_identification::results::Model;

/// A servo under one condition.
#[derive(Debug)]
pub struct Servo {
    /// What it is called.
    pub name: String,
    /// Its model.
    pub model: Model,
    /// How the model came about; not known of a model from a file.
    pub explanation: Option<Explanation>,
    /// What it was identified from; not known of a model from a file.
    pub data: Option<Dataset>,
    /// What is known of units and of what held the command.
    pub metadata: ModelMetadata,
    runs: Vec<Model>,
}

impl Servo {
    /// A model from a file.
    #[must_use]
    pub fn of_model(name: String, model: Model, metadata: ModelMetadata) -> Self {
        Self {
            name,
            model,
            explanation: None,
            data: None,
            metadata,
            runs: Vec::new(),
        }
    }

    /// What came of identifying `data`; its runs are identified one by one as well.
    #[must_use]
    pub fn of_data(name: String, data: Dataset, found: Identification) -> Self {
        let runs = runs_alone(&data.record, &found);
        Self {
            name,
            model: found.model,
            explanation: Some(found.explanation),
            metadata: ModelMetadata::from(&data.about),
            data: Some(data),
            runs,
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
            metadata: &self.metadata,
            provenance: data.map_or(&[], |data| &data.about.provenance),
        }
    }
}
