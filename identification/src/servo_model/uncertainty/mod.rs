//! How sure the estimate is, and what the equation lacks.

pub(super) mod covariance;
pub(super) mod current_limit;
pub(super) mod discrepancy;
mod drive_lag;
pub(super) mod hidden_parts;
mod known_beforehand;
pub(super) mod lack_of_fit;
mod motor_beside_limit;
pub(super) mod noise_at_rest;
mod play;
pub(super) mod possible_servo;
pub(super) mod run_offsets;
pub(super) mod score_test;
pub(super) mod stepped_outputs;
pub(super) mod stiction;
pub(super) mod unequal_sides;
pub(super) mod validity;
