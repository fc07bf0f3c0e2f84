//! One servo: the linear model, the servo model, the low-order model, and what is said of them.

pub(super) mod identification;
pub(super) mod identified;
pub(super) mod load_at_rest;
pub(super) mod low_order;
pub(super) mod model_text;
mod pulse_clock;
pub mod servo_fit;
mod waits;
