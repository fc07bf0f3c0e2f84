//! What an identification gives, as plain data.

pub mod frequency_response;
pub mod metrics;
pub mod model;
pub mod step_response;
pub mod validation;
