//! A run that models predict, sample by sample.

/// The measured output of a run, and what the models of a file predict of it from its commands.
#[derive(Clone, Debug, PartialEq)]
pub struct PredictedRun {
    /// Sample period \[s\].
    pub period_s: f64,
    /// The measured output; NaN where it is missing.
    pub measured: Vec<f64>,
    /// The output of the linear model, NaN where its history is not complete; `None` where that has no history at all.
    pub by_linear: Option<Vec<f64>>,
    /// The output of the servo model, where the file has one.
    pub by_servo: Option<Vec<f64>>,
}

impl PredictedRun {
    /// The measured output less a prediction of it.
    #[must_use]
    pub fn errors_of(&self, by: &[f64]) -> Vec<f64> {
        let pairs = self.measured.iter().zip(by);
        pairs.map(|(measured, by)| measured - by).collect()
    }
}
