//! Options of a comparison.

use crate::options::Options;

/// Options of a comparison.
#[derive(Debug, Clone, PartialEq)]
pub struct ComparisonOptions {
    /// Largest difference that still counts as the same \[% of the step\].
    pub margin_percent: f64,
    /// How the sides are identified; its level is that of every bound.
    pub identification: Options,
    /// Samples after an edge from which a plateau counts; `None` is the settling time of the first
    /// side.
    pub wait_samples: Option<usize>,
    /// Standard deviation of the sensor's zero between the two sides \[output\].
    pub zero_sd: f64,
    /// The output of each side may have been recorded earlier or later than its record says, by up to this \[s\]; models contain theirs.
    pub delay_errors_s: [f64; 2],
    /// Whether these errors are one and the same on both sides, as those of one sensor are: then nothing of them is in a difference.
    pub one_delay_error: bool,
    /// The size of all strokes in the recording of each of two models, where each has one \[input\]; records show theirs by themselves.
    pub strokes_of_models: Option<[f64; 2]>,
    /// The unit of the input, for sentences; empty when it is not known.
    pub input_unit: String,
    /// The unit of the output, likewise.
    pub output_unit: String,
}

impl Default for ComparisonOptions {
    fn default() -> Self {
        Self {
            margin_percent: 5.0,
            identification: Options::default(),
            wait_samples: None,
            zero_sd: 0.0,
            delay_errors_s: [0.0; 2],
            one_delay_error: false,
            strokes_of_models: None,
            input_unit: String::new(),
            output_unit: String::new(),
        }
    }
}
