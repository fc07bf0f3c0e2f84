//! What a page shows: one servo, or two held against each other.

use crate::data::model_metadata::ModelMetadata;
use crate::presentation::paper_values::Fact;
use crate::presentation::plots::paper_figures::Subject;
use servoid_identification::comparison::Comparison;
use servoid_identification::diagnostics::Explanation;
use servoid_identification::results::Model;

/// Name and value of each thing that is known about one file.
pub type Facts = Vec<(String, String)>;

/// One servo in the report.
#[derive(Clone, Copy, Debug)]
pub struct Part<'a> {
    /// Model, and record where there is one.
    pub subject: Subject<'a>,
    /// How the model came about, where that is known.
    pub explanation: Option<&'a Explanation>,
    /// Models of its runs, each identified on its own, where there are several.
    pub runs: &'a [Model],
    /// What is known of units and of what held the command.
    pub metadata: &'a ModelMetadata,
    /// Where the data come from, file by file.
    pub provenance: &'a [Facts],
}

/// What a page shows.
#[derive(Clone, Copy, Debug)]
pub struct Page<'a> {
    /// What it is called.
    pub title: &'a str,
    /// The servo, or the reference condition.
    pub first: Part<'a>,
    /// What it is held against.
    pub second: Option<Part<'a>>,
    /// The outcome of holding the two against each other.
    pub comparison: Option<&'a Comparison>,
    /// The paper's facts beside ours, where the servos are those of the paper.
    pub paper: &'a [Fact],
}

impl<'a> Page<'a> {
    /// The first servo, and the second where there is one.
    pub(super) fn parts(&self) -> impl Iterator<Item = &Part<'a>> {
        std::iter::once(&self.first).chain(&self.second)
    }
}
