//! Options of a comparison.

use crate::numerics::pointwise_critical;
use crate::options::Options;
use crate::results::Reason;

/// By how much the outputs of two sides may have been recorded earlier or later than they are taken for, at most \[s\]. Models contain their own
/// errors: of them only which of the two it is counts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum DelayErrors {
    /// By one and the same time, as that of one sensor is: nothing of it is in a difference.
    Shared(f64),
    /// Each by a time of its own: differences contain both.
    Apart([f64; 2]),
}

impl DelayErrors {
    /// Those of both sides \[s\].
    pub(super) fn of_sides(self) -> [f64; 2] {
        match self {
            Self::Shared(seconds) => [seconds; 2],
            Self::Apart(seconds) => seconds,
        }
    }
}

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
    /// By how much the output of either side may have been recorded earlier or later than its record says.
    pub delay_errors: DelayErrors,
    /// By how much the times of either recording may be late alike, by a wait of its own that the record does not know \[s\]: what that may make of a difference is none of the servos. Bounds
    /// that contain the scatter of three or more runs contain it.
    pub waits_s: [f64; 2],
    /// Standard deviation of the ratio of the scales of both outputs, 0.05 for 5 %. Zero where one sensor recorded both sides, whose error is the same
    /// in both.
    pub scale_sd: f64,
    /// The size of all strokes in the recording of each of two models, where it has one \[input\]; records show theirs by themselves.
    pub strokes_of_models: [Option<f64>; 2],
    /// What the caller knows of each record that leaves no bounds: then the other side has none, either.
    pub withheld: [Option<Reason>; 2],
    /// The unit of the input, for sentences; empty when it is not known.
    pub input_unit: String,
    /// The unit of the output, likewise.
    pub output_unit: String,
}

impl ComparisonOptions {
    /// The level of what noise and scatter add to bounds that hold at all points at once. Where the scale adds to them, too, each of the two may miss
    /// half as often (Bonferroni).
    pub(super) fn level_of_noise(&self) -> f64 {
        let level = self.identification.level;
        match self.scale_sd > 0.0 {
            true => (1.0 + level) / 2.0,
            false => level,
        }
    }

    /// By how much of itself the second output may be off in terms of the first, beside the noise of such bounds.
    pub(super) fn scale_beside_noise(&self) -> f64 {
        pointwise_critical(self.level_of_noise()) * self.scale_sd
    }

    /// The same by itself, at the level of the bounds.
    pub(super) fn scale_error(&self) -> f64 {
        pointwise_critical(self.identification.level) * self.scale_sd
    }
}

impl Default for ComparisonOptions {
    fn default() -> Self {
        Self {
            margin_percent: 5.0,
            identification: Options::default(),
            wait_samples: None,
            zero_sd: 0.0,
            delay_errors: DelayErrors::Apart([0.0; 2]),
            waits_s: [0.0; 2],
            scale_sd: 0.0,
            strokes_of_models: [None; 2],
            withheld: [None; 2],
            input_unit: String::new(),
            output_unit: String::new(),
        }
    }
}
