//! Properties that no linear model has: direction dependence, limits and hysteresis.

pub mod direction;
pub mod limits;
