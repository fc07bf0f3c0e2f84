//! When a finding is worth words, and metrics their numbers.

// Advice.

/// Standard deviations of a tail of the response that noise may hide after the settling time.
///
/// Protects: bounds that hold less often than their level, because a slow end is cut off. Evidence: the rows with
/// `hidden_tail` in "Poor references and coarse sensors"; the test of smooth references in noise.
pub const HIDDEN_TAIL: f64 = 0.5;

/// Largest root of D(z) that still is noise and not drift.
///
/// Protects: the bounds of the gain, which rest on few independent stretches of noise that drifts. Evidence: the test
/// of slow noise.
pub const SLOW_ROOT: f64 = 0.98;

/// Fewer degrees of freedom than this make the width of a bound itself uncertain, by more than 13 %.
///
/// Protects: readers from widths that another recording would not repeat. Evidence: the test of slow noise.
pub const FEW_DEGREES: f64 = 30.0;

/// Share of the rows that may be parameters.
///
/// Protects: the estimate of the noise, which needs rows beside the parameters. Evidence: the test of short records.
pub const LARGE_SHARE: f64 = 0.25;

/// Share of the samples that may serve as history alone.
///
/// Protects: users from recording many short runs. Evidence: the test of short records.
pub const LOST_TO_HISTORY: f64 = 0.2;

// Metrics.

/// Standard deviations beyond which a sample is surely on one side of a level; a draw lies outside once in 5e8.
///
/// Protects: the intervals of crossings from samples that cannot matter. Evidence: table of the metrics' intervals,
/// the test that sure crossings have the intervals of draws.
pub const SURE: f64 = 6.0;

/// Standard deviations by which each step of a curve must go up for it to be surely rising; one draw in 30 000 has
/// it go down.
///
/// Protects: intervals by inversion, which suppose a single crossing. Evidence: as for [`SURE`].
pub const RISING: f64 = 4.0;

/// Half width of the bound of a single sample, as a share of the final value, from which on crossings have brackets
/// instead of quantiles of draws.
///
/// Protects: crossings of rough estimates, whose draws are rougher still and miss. Evidence: table of the metrics'
/// intervals, strong noise.
pub const ROUGH_SAMPLE: f64 = 0.05;

/// Standard deviations by which the power at the upper frequencies may be larger, or smaller, than it seems.
///
/// Protects: the bandwidth and the bounds above it from what sampling folds down from beyond half its rate, where
/// noise hides how much that is. Evidence: the tests of aliasing; the tests of coarse sampling.
pub const FOLDED_POWER_DOUBT: f64 = 3.0;

/// Probability below which the output has a trend that the input does not explain.
///
/// Protects: servos under a drifting sensor from being called nonlinear. Evidence: the tests of drift.
pub const DRIFT_SIGNIFICANCE: f64 = 1e-4;

/// Share of its last value by which a response rises in its last quarter, from which on it has no end there. A straight line
/// has a quarter.
///
/// Protects: users of integrators from the advice to record longer. Evidence: the test of integrators.
pub const STILL_RISING: f64 = 0.15;
