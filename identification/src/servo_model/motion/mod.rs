//! The motion of a servo, as recorded and as simulated.

pub(super) mod command_range;
pub(super) mod reached_speeds;
pub(super) mod recorded_motion;
pub(super) mod simulated_motion;
