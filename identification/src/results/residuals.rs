//! The p-values of the residual tests, as plain data.

use serde::{Deserialize, Serialize};

/// p-values of the tests; `None` where the data do not allow the test.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Residuals {
    /// Probability of autocorrelations at least as large if the one-step errors are white.
    pub whiteness_p: Option<f64>,
    /// Probability of a relation to further input at least as strong if there is none.
    pub input_correlation_p: Option<f64>,
    /// Probability of a relation to functions of the motion at least as strong if the servo is linear
    /// (see [`Linearity`](crate::diagnostics::Linearity)).
    #[serde(default)]
    pub linearity_p: Option<f64>,
    /// Part of the motion that these functions explain beyond any linear model \[% rms\]. Without a small p
    /// it is noise.
    #[serde(default)]
    pub beyond_linear_percent: Option<f64>,
    /// Probability of errors in motion at least as large if they are the noise at standstill (see
    /// [`StandstillNoise`](crate::diagnostics::StandstillNoise)); `None` without a recording at rest.
    #[serde(default)]
    pub rest_p: Option<f64>,
    /// Part of the motion that neither the simulation nor the noise at standstill explains \[% rms\].
    /// Without a small p it is noise.
    #[serde(default)]
    pub beyond_rest_percent: Option<f64>,
}
