//! Is the second servo different from the first, and by how much?
//!
//! **The verdict is against a margin**, not against zero. With d_m the difference of the response
//! curves, s_m its standard deviation and q the critical value of all points at once,
//!
//! ```text
//! L = max_m (|d_m| - q s_m) / G0      U = max_m (|d_m| + q s_m) / G0
//! different if L > margin;  same if U <= margin;  undecided otherwise
//! ```
//!
//! so that "different by at least L" and "by at most U" hold with the probability of the level. One
//! servo recorded twice is never exactly the same: supply, friction and the phase of the clocks
//! scatter from run to run, and a test against zero would call almost every pair different.
//!
//! **A p-value** therefore needs three runs a side or more; it counts scatter between runs. When it
//! does not confirm a difference beyond the margin, the verdict is undecided.
//!
//! When a side answers up and down strokes differently ([`DirectionModel`](crate::nonlinear::DirectionModel)), both curves enter.
//! Differences of single metrics are intervals from the intervals of both sides (G. Y. Zou and
//! A. Donner, Statistics in Medicine 2008): with d = b - a,
//!
//! ```text
//! from d - sqrt((b - b_low)² + (a_up - a)²)   to d + sqrt((b_up - b)² + (a - a_low)²)
//! ```

mod advice;
mod compare;
mod difference;
mod difference_curves;
mod metric_differences;
mod motion;
mod options;
mod outcome;
mod over_prediction;
mod pair;
mod scatter;
mod servo_models;
mod shift;
mod words;

pub use compare::{compare, compare_models};
pub use motion::Motion;
pub use options::ComparisonOptions;
pub use outcome::{
    Asymmetry, Comparison, ComparisonBounds, CurveBounds, DifferenceCurve, DifferencePercent,
    Direction, Levels, MetricDifference, SCHEMA, Sides, Verdict,
};
pub use over_prediction::OverPrediction;
pub use servo_models::{
    QuantityDifference, QuantityDifferences, QuantityPair, ServoModelComparison,
    compare_servo_models,
};
