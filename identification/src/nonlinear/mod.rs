//! Properties that no linear model has: direction dependence, limits and hysteresis.

mod direction;
mod limits;

pub(crate) use direction::split_with;
pub use direction::{DirectionModel, Symmetry, split_by_direction};
pub use limits::{
    Cell, Hysteresis, Limits, RangeEnd, Rate, RateVerdict, Side, SpeedLimits, rests_apart,
};
