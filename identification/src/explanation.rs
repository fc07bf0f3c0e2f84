//! How a model came about: what was considered, and why this was chosen.

use serde::{Deserialize, Serialize};

use crate::model_error::ModelErrors;
use crate::nested::BankCandidate;
use crate::noise::OrderCandidate;
use crate::normal::Path;
use crate::runs::RunComparison;
use crate::structure::Choice;

/// The way to a model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Explanation {
    /// The choice of the settling time; `None` when it was given.
    pub settling: Option<Choice>,
    /// Banks at that settling time, by number of frequencies; empty when n was given.
    pub frequencies: Vec<BankCandidate>,
    /// Noise orders; empty when d was given.
    pub noise_orders: Vec<OrderCandidate>,
    /// Which arithmetic was used.
    pub path: Path,
    /// Condition number of the normal equations (1-norm, offset projected out).
    pub condition: f64,
    /// Rows of the regression.
    pub rows: usize,
    /// Degrees of freedom behind each standard deviation of the step response.
    pub degrees_of_freedom: Vec<f64>,
    /// What was found when the errors are not noise; `None` when they are.
    pub model_errors: Option<ModelErrors>,
    /// How the runs compare; `None` with fewer than two.
    pub runs: Option<RunComparison>,
}
