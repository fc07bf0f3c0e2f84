//! How to read files of other programs.

use super::time_column::TimeUnit;

/// How to read files that are not recordings of this program.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DatasetOptions {
    /// The column with the input.
    pub input: Option<String>,
    /// The column with the output.
    pub output: Option<String>,
    /// Time between rows (s).
    pub period_s: Option<f64>,
    /// The column of time; without it, one that is called like one.
    pub time: Option<String>,
    /// The unit of a column of time whose name does not say it.
    pub time_unit: Option<TimeUnit>,
    /// The column whose value changes where a new run begins.
    pub run: Option<String>,
    /// The column that says which controller drove a run.
    pub controller: Option<String>,
    /// The input before the first row of each run.
    pub at_rest: Option<f64>,
    /// Use the rest around the reference too.
    pub with_rest: bool,
}
