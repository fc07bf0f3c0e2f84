//! The content of a page: one servo, or two and their comparison.

use crate::data::HeldOutPrediction;
use crate::data::model_file::ServoModelDocument;
use crate::data::model_metadata::ModelMetadata;
use crate::presentation::paper_values::Fact;
use crate::presentation::plots::Subject;
use servoid_identification::comparison::{Comparison, ServoModelComparison};
use servoid_identification::diagnostics::Explanation;
use servoid_identification::flight_model::FlightModel;
use servoid_identification::results::Model;

/// Names and values of what is known of one file.
pub type Facts = Vec<(String, String)>;

/// One servo in the report.
#[derive(Clone, Copy, Debug)]
pub struct Part<'a> {
    /// Model, and record where there is one.
    pub subject: Subject<'a>,
    /// The choice of the model's structure, where that is known.
    pub explanation: Option<&'a Explanation>,
    /// Models of its runs, each identified on its own, where there are several.
    pub runs: &'a [Model],
    /// The servo as a machine, where that was found.
    pub servo_model: Option<&'a ServoModelDocument>,
    /// The low-order model, where the response is known in a band alone.
    pub low_order: Option<&'a FlightModel>,
    /// A stretch that the models had not seen, where both were identified without one.
    pub held_out: Option<&'a HeldOutPrediction>,
    /// Whether it was recorded with the paper's reference: servoid's own staircase.
    pub staircase: bool,
    /// Units, and the hold of the command.
    pub metadata: &'a ModelMetadata,
    /// The origin of the data, file by file.
    pub provenance: &'a [Facts],
}

/// The content of a page: one servo, or two and their comparison.
#[derive(Clone, Copy, Debug)]
pub struct Page<'a> {
    /// Its title.
    pub title: &'a str,
    /// The servo, or the reference condition.
    pub first: Part<'a>,
    /// The other condition.
    pub second: Option<Part<'a>>,
    /// The comparison of the two.
    pub comparison: Option<&'a Comparison>,
    /// The two servos as machines beside each other, where both were found.
    pub servo_models: Option<&'a ServoModelComparison>,
    /// The paper's values beside those found here, where the servos are those of the paper.
    pub paper: &'a [Fact],
}

impl<'a> Page<'a> {
    /// The first servo, and the second where there is one.
    pub(super) fn parts(&self) -> impl Iterator<Item = &Part<'a>> {
        std::iter::once(&self.first).chain(&self.second)
    }
}
