//! The linear and the low-order model in words: the first finding, the sentence, the tables.

pub(super) mod at_frequencies;
pub(super) mod beyond_linear;
pub(super) mod first_finding;
pub(super) mod linear_model;
pub(super) mod low_order;
pub(super) mod metrics;
pub(super) mod model_sentence;
