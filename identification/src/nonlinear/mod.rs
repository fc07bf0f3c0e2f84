//! What a linear model cannot show.

pub mod direction;
pub mod limits;
