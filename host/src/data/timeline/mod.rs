//! Where the rows of a table lie in time: which run each belongs to, and which sample of it each is.
//!
//! A column of time shows where rows are missing and where another run begins; taking such rows for
//! neighbours would shift every sample behind them.

mod stretches;
mod time_stamps;

pub use stretches::{Stretch, stretches};
pub use time_stamps::{TimeColumn, TimeFault};

#[cfg(test)]
mod tests;
