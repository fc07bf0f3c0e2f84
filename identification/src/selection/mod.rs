//! The choice of the settling time and of the number of frequencies.

pub mod choice;
pub(crate) mod complete_bank;
pub(crate) mod long_fit;
pub(crate) mod noise_filter;
pub(crate) mod repetition;
pub(crate) mod search;
pub mod settling_range;
pub(crate) mod settling_time;
pub(crate) mod shorter_history;
pub(crate) mod smooth_input;
