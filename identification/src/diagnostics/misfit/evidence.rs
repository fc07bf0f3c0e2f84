//! Evidence that errors are not noise, as plain data.

use serde::{Deserialize, Serialize};

use crate::diagnostics::linearity::{BetweenRuns, Linearity};

/// An estimator and how it predicts.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Prediction {
    /// N \[samples\].
    pub settling: usize,
    /// n.
    pub frequencies: usize,
    /// Whether the noise is modelled; otherwise plain least squares.
    pub generalised: bool,
    /// Fit of simulations of the parts left out \[%\].
    pub cross_validated_percent: f64,
}

/// Errors that are not noise, and the estimators that were compared because of them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Misfit {
    /// Simulation fit of plain least squares \[%\].
    pub least_squares_percent: f64,
    /// Simulation fit of generalised least squares \[%\].
    pub generalised_percent: f64,
    /// Those that predict parts they have not seen better than the mean of these parts does, best first; the first
    /// was taken. Without any, the estimator that simulates the record better.
    pub candidates: Vec<Prediction>,
    /// Step response of the estimator that was not taken, at the same N and n.
    pub other_step: Vec<f64>,
    /// The lowest frequency at which the input does not determine the response \[Hz\], when it lacks high
    /// frequencies.
    #[serde(default)]
    pub unexcited_above_hz: Option<f64>,
    /// The evidence for it.
    #[serde(default, rename = "sign")]
    pub evidence: MisfitEvidence,
}

/// The evidence that errors are not noise.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum MisfitEvidence {
    /// Generalised least squares simulates worse than plain least squares.
    #[default]
    Whitening,
    /// The errors follow the motion, and the simulation leaves much of the motion unexplained.
    Misfit(Linearity),
    /// The simulation leaves much of the motion unexplained, and the runs differ by more than their noise: a
    /// model of all of them describes none.
    Runs(BetweenRuns),
    /// The response comes to rest, and moves again by this share of its largest value when the input is changed next.
    MovesAgain(f64),
    /// The response of the model goes on for so many holds of the input, although the output rests before each of them ends.
    OutlastsHolds(f64),
    /// The servo is not linear, and an N was stated that is longer than this, the usual hold \[samples\].
    StatedBeyondHold(usize),
    /// The servo is not linear, and only this share of the steps of the input are held until it has
    /// followed.
    NoSteps(Linearity, f64),
}

impl Misfit {
    /// Share of the motion that the better of the two estimators leaves unexplained \[% rms\].
    #[must_use]
    pub fn unexplained_percent(&self) -> f64 {
        100.0 - self.least_squares_percent.max(self.generalised_percent)
    }

    /// Largest difference between the step responses of the two estimators, as a share of the
    /// largest value of `taken`. Infinite when there is no other.
    #[must_use]
    pub fn disagreement(&self, taken: &[f64]) -> f64 {
        let largest = taken.iter().fold(0.0f64, |a, g| a.max(g.abs()));
        let apart = taken
            .iter()
            .zip(&self.other_step)
            .map(|(a, b)| (a - b).abs())
            .fold(0.0, f64::max);
        if self.other_step.len() == taken.len() && largest > 0.0 {
            apart / largest
        } else {
            f64::INFINITY
        }
    }
}
