//! What differs from run to run, and along a run.

pub(super) mod changed_servo;
pub(super) mod common_offset;
pub(super) mod delayed_response;
pub(super) mod gain_drift;
pub(super) mod initial_rest;
pub(super) mod lag_drift;
pub(super) mod run_blocks;
pub(super) mod run_equations;
pub(super) mod run_offsets;
pub(super) mod run_scatter;
pub(super) mod run_trends;
pub(super) mod servo_mean;
pub(super) mod start_elsewhere;
