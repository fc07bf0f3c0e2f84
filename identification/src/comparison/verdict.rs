//! Whether two servos differ by more than a margin.

use serde::{Deserialize, Serialize};

/// The answer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Verdict {
    /// By more than the margin.
    Different,
    /// Within the margin.
    Same,
    /// The recordings allow both.
    Undecided,
}

impl Verdict {
    /// Different where the interval of the largest difference, from `at_least` to `at_most`, lies beyond the margin, the same where it lies
    /// within, and else undecided.
    pub(super) fn of([at_least, at_most]: [f64; 2], margin: f64) -> Self {
        if at_least > margin {
            Self::Different
        } else if at_most <= margin {
            Self::Same
        } else {
            Self::Undecided
        }
    }
}
