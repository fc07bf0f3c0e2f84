//! The results of an identification, as plain data.

mod advice;
mod band_estimate;
mod frequency_response;
mod metrics;
mod model;
mod residuals;
mod servo_response;
mod step_response;
mod usable_numbers;
mod validation;
mod validity;

pub use crate::estimation::Noise;
pub use crate::numerics::{
    command_in_words, pointwise_critical, six_digits, student_critical, with_unit,
};
pub use advice::{Advice, Check, Precedence, Setting};
pub use band_estimate::BandEstimate;
pub use frequency_response::{FrequencyBounds, FrequencyResponse};
pub(crate) use frequency_response::{frequency_grid, frequency_map};
pub(crate) use metrics::in_band::BandPoint;
pub(crate) use metrics::measured::Measured;
pub use metrics::{Interval, MetricBounds, Metrics, Withheld};
pub use model::{Fit, MODEL_SCHEMA, Model, ParameterBounds, SelectedBy, Structure};
pub use residuals::Residuals;
pub(crate) use step_response::{Biases, farthest_within};
pub use step_response::{PointwiseBand, SimultaneousBand, StepBounds, StepResponse};
pub(crate) use usable_numbers::is_sized;
pub use validation::Validation;
pub(crate) use validation::{command_before, fit_percent};
pub use validity::{Bounds, Reason, Withdrawn};
