//! What a fit leaves of a record, and tests of it.

pub(super) mod correlogram;
pub(super) mod filtered_rows;
pub(super) mod further_columns;
pub(super) mod noise_prediction;
pub(super) mod part_means;
pub(super) mod residual_tests;
pub(super) mod run_columns;
pub(super) mod simulation_error;
