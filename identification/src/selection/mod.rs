//! The choice of the settling time and of the number of frequencies.

pub mod long_fit;
pub mod repetition;
pub mod settling_time;
pub mod smooth_input;
