//! What a recording shows beside its model: units, period, travel, and levels that are not reached.

pub(super) mod angle_units;
pub(super) mod no_step;
pub(super) mod sample_period;
pub(super) mod short_of_command;
pub(super) mod travel;
