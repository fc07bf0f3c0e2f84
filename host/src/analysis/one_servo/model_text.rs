//! What is said of a model: the text that `servoid identify` prints, also of a model that was read from its file.

use crate::data::model_file::{ModelFile, ModelFileError, ServoModelDocument};
use crate::data::model_metadata::ModelMetadata;
use crate::presentation::{explanation, summary};
use servoid_identification::diagnostics::{Explanation, PriorOutcome};
use servoid_identification::flight_model::FlightModel;
use servoid_identification::nonlinear::Limits;
use servoid_identification::results::Model;

/// A model with what was found beside it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ModelText<'a> {
    pub model: &'a Model,
    pub metadata: &'a ModelMetadata,
    /// The servo model, or the reason why there is none.
    pub servo_model: (Option<&'a ServoModelDocument>, Option<&'a str>),
    /// The choice of the structure, where it is to be explained.
    pub explanation: Option<&'a Explanation>,
    /// What became of the prior that was asked for.
    pub prior: Option<&'a PriorOutcome>,
    /// The low-order model, or the reason why there is none.
    pub flight_model: (Option<&'a FlightModel>, Option<&'a str>),
    /// Motion that is not linear, and how up and down strokes compare.
    pub limits: Option<(&'a Limits, &'a str)>,
}

impl ModelText<'_> {
    /// The text of data, or of a model, of this name. `picture` is one of the step response.
    pub fn in_words(&self, name: &str, picture: &str) -> String {
        let (model, units) = (self.model, self.metadata.units());
        let (servo_model, no_servo_model) = self.servo_model;
        let (flight_model, no_flight_model) = self.flight_model;
        let extent = (picture, self.explanation.is_some());
        let mut text = summary::of_both_models(
            name,
            model,
            self.metadata,
            servo_model,
            flight_model,
            extent,
        );
        text.extend(no_servo_model.map(|reason| {
            let line = format!("no servo model: {reason}");
            format!("\n{}\n", summary::wrapped(&line, 0))
        }));
        text.extend(self.explanation.map(|e| explanation::as_text(e, model)));
        // Whoever asked for a prior wants to know what became of it; with --explain it is among the reasons.
        let prior = self.prior.filter(|_| self.explanation.is_none());
        text.extend(prior.map(|prior| format!("\n{}\n", summary::wrapped(&prior.in_words(), 0))));
        text.extend(flight_model.map(|flight| summary::of_flight_model(flight, model.linear)));
        text.extend(no_flight_model.map(|reason| format!("\nno low-order model: {reason}\n")));
        text.extend(
            self.limits
                .map(|(limits, strokes)| summary::of_limits(limits, strokes, units.common())),
        );
        text
    }
}

/// What `servoid identify` printed when it wrote this file, but for the picture and for a prior that is not explained; the model is called
/// `name`.
///
/// # Errors
/// The servo model or the low-order model cannot be read.
pub fn text_of_file(file: &ModelFile, name: &str) -> Result<String, ModelFileError> {
    let (servo_model, flight_model) = (file.servo_model()?, file.flight_model()?);
    let explanation = file.explanation();
    let limits = file.limits();
    let strokes = match file.compares_strokes() {
        true => file.strokes_in_words(),
        false => Some(summary::STROKES_OF_ONE_DIRECTION),
    };
    let text = ModelText {
        model: &file.model,
        metadata: &file.metadata,
        servo_model: (servo_model.as_ref(), file.text("no_servo_model")),
        explanation: explanation.as_ref(),
        prior: None,
        flight_model: (flight_model.as_ref(), file.text("no_flight_model")),
        limits: limits.as_ref().zip(strokes),
    };
    Ok(text.in_words(name, ""))
}
