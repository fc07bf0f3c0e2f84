//! One identification with all that may follow it: servo model, low-order model, limits.

use super::identified::identified;
use super::load_at_rest;
use super::low_order::low_order;
use super::model_text::ModelText;
use super::servo_fit::{self, ServoModelSearch};
use crate::data::HeldOutPrediction;
use crate::data::dataset::{Dataset, DatasetOptions};
use crate::data::model_file::{ModelDocument, ServoModelDocument};
use crate::data::model_metadata::ModelMetadata;
use crate::presentation::{scope, summary};
use anyhow::Result;
use serde::Serialize;
use servoid_identification::diagnostics::{Explanation, PriorOutcome};
use servoid_identification::flight_model::FlightModel;
use servoid_identification::nonlinear::{DirectionModel, Limits, split_by_direction};
use servoid_identification::results::{Advice, Model, StepResponse};
use servoid_identification::servo_model::Watch;
use servoid_identification::{Identification, Options};

/// What is to be found.
#[derive(Clone, Copy, Debug, Default)]
pub struct IdentifyRequest {
    /// Structure and level.
    pub options: Options,
    /// Whether the choice of the structure is explained.
    pub explain: bool,
    /// Whether a low-order model is fitted where the linear model has bounds of more than a band, or none, too.
    pub flight_model: bool,
    /// When a servo model is looked for.
    pub servo_model: ServoModelSearch,
    /// Whether motion that is not linear is looked for.
    pub limits: bool,
    /// Whether a servo model shows how it predicts a stretch that it has not seen.
    pub held_out: bool,
}

/// What was found.
#[derive(Debug)]
pub struct Identified {
    /// The linear model.
    pub model: Model,
    /// The choice of its structure.
    pub explanation: Explanation,
    /// The low-order model or the reason why there is none, where one was wanted.
    pub flight_model: Option<Result<FlightModel, String>>,
    /// The servo model or the reason why there is none, where one was looked for.
    pub servo_model: Option<Result<ServoModelDocument, String>>,
    /// How the servo model predicts a stretch that it has not seen.
    pub held_out: Option<HeldOutPrediction>,
    /// Motion that is not linear; the responses to strokes up and down apart are there where the record has both.
    pub limits: Option<(Limits, Option<DirectionModel>)>,
    explain: bool,
}

/// Columns and rows of the picture of the step response: a terminal of 80 columns and 24 rows shows it with the sentence.
const PICTURE: (u16, u16) = (78, 16);

impl Identified {
    /// Identifies the data, which are called `name`. `watch` begins the search for a servo model.
    ///
    /// # Errors
    /// As [`identified()`].
    pub fn of<W: Watch>(
        data: &Dataset,
        name: &str,
        request: &IdentifyRequest,
        watch: impl FnOnce() -> W,
    ) -> Result<Self> {
        let options = &request.options;
        let mut found = identified(data, name, options)?;
        let flight_model = low_order(request.flight_model, data, &found);
        let servo = servo_fit::is_wanted(request.servo_model, &found)
            .then(|| servo_fit::find(data, &mut found, options, request.held_out, &watch()));
        let Identification {
            mut model,
            explanation,
        } = found;
        let (servo_model, held_out) = match servo {
            Some(found) => (Some(found.model), found.held_out),
            None => (None, None),
        };
        let (servo, _) = parts(&servo_model);
        if let Some((by_load, remedy)) =
            servo.and_then(|servo| load_at_rest::remedy(&servo.model, data.about.units()))
        {
            Advice::name_load(&mut model.advice, Some(by_load), &remedy);
        }
        if let Some([_, percent]) = servo.and_then(|servo| servo.model.beyond_linear_percent()) {
            Advice::name_servo_model(&mut model.advice, percent);
        }
        let limits = request.limits.then(|| {
            let limits = Limits::of(&data.record, &model, options.level);
            // A recording with strokes of one direction only has no split; the summary mentions it.
            (limits, split_by_direction(&data.record, &model).ok())
        });
        Ok(Self {
            model,
            explanation,
            flight_model,
            servo_model,
            held_out,
            limits,
            explain: request.explain,
        })
    }

    /// The choice of the structure, where it was asked for.
    #[must_use]
    pub fn explanation(&self) -> Option<&Explanation> {
        self.explain.then_some(&self.explanation)
    }

    /// The document of all this, to be written as JSON. `read_as` is how the data were read.
    #[must_use]
    pub fn document<'a>(
        &'a self,
        data: &'a Dataset,
        read_as: DatasetOptions,
    ) -> IdentifiedDocument<'a> {
        let (flight_model, no_flight_model) = parts(&self.flight_model);
        let (servo_model, no_servo_model) = parts(&self.servo_model);
        let split = self.limits.as_ref().and_then(|(_, split)| split.as_ref());
        let directions = split.zip(self.strokes_in_words());
        IdentifiedDocument {
            model: ModelDocument {
                model: &self.model,
                metadata: ModelMetadata::from(&data.about),
                record: Some(&data.record),
                servo_model,
            },
            read_as,
            remarks: self.remarks(data),
            explanation: self.explanation(),
            flight_model,
            no_flight_model,
            no_servo_model,
            limits: self.limits.as_ref().map(|(limits, _)| limits),
            directions: directions.map(Directions::from),
        }
    }

    /// All this as text. With `picture`, the step response is drawn where it is a finding.
    #[must_use]
    pub fn as_text(&self, data: &Dataset, name: &str, picture: bool) -> String {
        let model = &self.model;
        let (flight_model, no_flight_model) = parts(&self.flight_model);
        let (servo_model, no_servo_model) = parts(&self.servo_model);
        // A step response of which not even the times are findings is no picture of the servo.
        let picture = match picture && model.metrics.withheld.is_none() {
            true => scope::step_as_text(&model.step, PICTURE.0, PICTURE.1),
            false => String::new(),
        };
        let strokes = self.strokes_in_words();
        let limits = self.limits.as_ref().map(|(limits, _)| limits);
        let text = ModelText {
            model,
            metadata: &ModelMetadata::from(&data.about),
            servo_model: (servo_model, no_servo_model.map(String::as_str)),
            explanation: self.explanation(),
            prior: self.explanation.prior.as_ref(),
            flight_model: (flight_model, no_flight_model.map(String::as_str)),
            limits: limits.zip(strokes.as_deref()),
        };
        text.in_words(name, &picture)
    }

    /// How up and down strokes compare, where that was looked for.
    fn strokes_in_words(&self) -> Option<String> {
        let (limits, split) = self.limits.as_ref()?;
        Some(summary::of_strokes(limits, split.as_ref()))
    }

    /// How the data were read, and what became of a prior that is not used.
    fn remarks(&self, data: &Dataset) -> Vec<String> {
        let read = data.about.remarks.iter().cloned();
        read.chain(self.prior_not_used()).collect()
    }

    /// What became of the prior that was asked for, where it is not used.
    #[must_use]
    pub fn prior_not_used(&self) -> Option<String> {
        let prior = self.explanation.prior.as_ref()?;
        (!matches!(prior, PriorOutcome::Used { .. })).then(|| prior.in_words())
    }
}

/// What was found, and the reason why nothing was; nothing of either where nothing was looked for.
fn parts<T>(found: &Option<Result<T, String>>) -> (Option<&T>, Option<&String>) {
    match found {
        Some(Ok(found)) => (Some(found), None),
        Some(Err(reason)) => (None, Some(reason)),
        None => (None, None),
    }
}

/// The model as `--json` prints it and `-o` writes it, with the further results that were asked for.
#[derive(Debug, Serialize)]
pub struct IdentifiedDocument<'a> {
    #[serde(flatten)]
    model: ModelDocument<'a>,
    #[serde(skip_serializing_if = "DatasetOptions::are_default")]
    read_as: DatasetOptions,
    /// How the files were read, a sentence each.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    remarks: Vec<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    explanation: Option<&'a Explanation>,
    #[serde(skip_serializing_if = "Option::is_none")]
    flight_model: Option<&'a FlightModel>,
    /// The reason why there is none though one was asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    no_flight_model: Option<&'a String>,
    /// The reason why there is no servo model though one was looked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    no_servo_model: Option<&'a String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    limits: Option<&'a Limits>,
    #[serde(skip_serializing_if = "Option::is_none")]
    directions: Option<Directions<'a>>,
}

/// Up and down strokes apart. Whether they differ is `null` where bounds are withdrawn.
#[derive(Debug, Serialize)]
struct Directions<'a> {
    asymmetric: Option<bool>,
    p: Option<f64>,
    largest_difference_percent: Option<f64>,
    at_s: Option<f64>,
    /// The same in words.
    statement: String,
    up: &'a StepResponse,
    down: &'a StepResponse,
}

impl<'a> From<(&'a DirectionModel, String)> for Directions<'a> {
    fn from((split, statement): (&'a DirectionModel, String)) -> Self {
        let symmetry = split.symmetry.valid();
        Self {
            asymmetric: symmetry.map(|found| found.asymmetric),
            p: symmetry.map(|found| found.p),
            largest_difference_percent: symmetry.map(|found| 100.0 * found.largest_difference),
            at_s: symmetry.map(|found| found.at_s),
            statement,
            up: &split.up,
            down: &split.down,
        }
    }
}
