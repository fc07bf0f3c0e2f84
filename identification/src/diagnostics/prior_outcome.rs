//! What became of the stable prior that was asked for.

use serde::{Deserialize, Serialize};

use crate::results::Bounds;

/// The stable prior, where it was asked for.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", tag = "outcome")]
pub enum PriorOutcome {
    /// Response and bounds are those under it.
    Used {
        /// Time constants of its two kernels, the shorter first \[s\].
        time_constants_s: Vec<f64>,
        /// Largest difference from the response without it, in standard deviations.
        contradiction: f64,
    },
    /// The data contradict it: response and bounds are those without it.
    Contradicted {
        /// Largest difference between the responses with and without it, in standard deviations.
        contradiction: f64,
    },
    /// The response may go on beyond N: slow ends of this size are hidden by the noise, or one is seen. Response and bounds are those without
    /// the prior, which allow for such ends.
    SlowEnd {
        /// Standard deviation of a slow end \[% of the gain\]; `None` where no settling time was found in the record.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        hidden_percent: Option<f64>,
    },
    /// Bounds hold for other reasons alone, or not at all: the input leaves frequencies out, or the errors are not noise.
    NotApplicable,
    /// Its numbers cannot be found from so little data.
    NotFound,
}

impl PriorOutcome {
    /// The same beside bounds of this `level`: without bounds, the standard deviation of a slow end is no reason.
    pub(crate) fn beside(self, level: Bounds<f64>) -> Self {
        match self {
            Self::SlowEnd {
                hidden_percent: Some(_),
            } if level.valid().is_none() => Self::NotApplicable,
            outcome => outcome,
        }
    }

    /// In a sentence.
    #[must_use]
    pub fn in_words(&self) -> String {
        match self {
            Self::Used {
                time_constants_s,
                contradiction,
            } => {
                let times: Vec<String> = time_constants_s
                    .iter()
                    .map(|seconds| format!("{seconds:.3} s"))
                    .collect();
                format!(
                    "Prior: the response dies out with time constants of {} and is smooth; the response without this differs \
                     by {contradiction:.1} standard deviations at the most.",
                    times.join(" and ")
                )
            }
            Self::Contradicted { contradiction } => format!(
                "Prior: not used, because the response without it differs by {contradiction:.1} standard deviations of that difference."
            ),
            Self::SlowEnd {
                hidden_percent: Some(percent),
            } => format!(
                "Prior: not used, because a slow end of the response is known to {percent:.1} % of the gain only (standard deviation), and it \
                 would not be in the band."
            ),
            Self::SlowEnd {
                hidden_percent: None,
            } => "Prior: not used, because the response goes on beyond the settling times that can be judged.".to_owned(),
            Self::NotApplicable => {
                "Prior: not used, because no bounds can be given, or the input does not excite all frequencies.".to_owned()
            }
            Self::NotFound => {
                "Prior: not used, because its numbers cannot be found from this recording.".to_owned()
            }
        }
    }
}
