//! The fit of chosen terms by simulation error.

pub(super) mod chosen_terms;
pub(super) mod coordinates;
pub(super) mod error_row;
pub(super) mod fit;
pub(super) mod initial_state;
pub(super) mod offsets;
pub(super) mod starting_values;
pub(super) mod step;
