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
//! **What the verdict is of.** With fewer than three runs on a side, d_m and s_m are those of these recordings and their noise.
//! With three or more a side they are those of the servos: d_m of the means of the runs, and q s_m of Welch's interval about it
//! where that is wider than the noise.
//!
//! **Scales.** Where two sensors recorded the sides, with r the standard deviation of the ratio of their scales and b_m the second curve, z r |b_m| is added
//! to q s_m, and each of z and q is taken for half of what may miss. One scale moves all points together, so L is the least that this maximum is at any scale that
//! is possible. One sensor errs alike on both sides: r is zero.
//!
//! When a side answers up and down strokes differently ([`DirectionModel`](crate::nonlinear::DirectionModel)), both curves enter.
//! Differences of single metrics are intervals from the intervals of both sides (G. Y. Zou and
//! A. Donner, Statistics in Medicine 2008): with d = b - a,
//!
//! ```text
//! from d - sqrt((b - b_low)² + (a_up - a)²)   to d + sqrt((b_up - b)² + (a - a_low)²)
//! ```

mod advice;
mod at_one_angle;
mod compare;
mod difference;
mod difference_curves;
mod different_motions;
mod first_answer;
mod metric_differences;
mod more_play;
mod motion;
mod options;
mod other_way;
mod outcome;
mod over_prediction;
mod pair;
mod rests_apart;
mod run_means;
mod scatter_of_curves;
mod servo_models;
mod shift;
mod shift_alone;
mod sides;
mod stroke_sizes;
mod verdict;
mod wear;
mod welch;
mod words;

pub use advice::SIDES;
pub use compare::{compare, compare_models};
pub use more_play::MorePlay;
pub use motion::Motion;
pub use options::{ComparisonOptions, DelayErrors};
pub use outcome::{
    Asymmetry, Comparison, ComparisonBounds, CurveBounds, DifferenceCurve, DifferencePercent,
    Direction, Levels, MetricDifference, SCHEMA, Subject,
};
pub use over_prediction::OverPrediction;
pub use rests_apart::RestsApart;
pub use servo_models::{
    QuantityDifference, QuantityDifferences, QuantityPair, ServoModelComparison, SpeedLimitsOfBoth,
    StrokeTimes, compare_servo_models,
};
pub use sides::Sides;
pub use verdict::Verdict;
