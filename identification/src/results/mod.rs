//! The results of an identification, as plain data.

pub mod advice;
pub mod frequency_response;
pub mod metrics;
pub mod model;
pub mod residuals;
pub mod servo_response;
pub mod step_response;
pub(crate) mod usable;
pub mod validation;
pub mod validity;
