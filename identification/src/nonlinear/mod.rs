//! Properties that no linear model has: direction dependence, limits and hysteresis.

mod direction;
mod limits;

pub use direction::{DirectionModel, Symmetry, split_by_direction};
pub(crate) use direction::{explains_errors, split_with};
pub use limits::{
    Cell, Hysteresis, Limits, MissedRest, RangeEnd, Rate, RateVerdict, Side, SpeedLimits,
    missed_rests,
};
