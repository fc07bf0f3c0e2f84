//! What no linear model has: asymmetry, hysteresis, limits.

/// Probability of calling a symmetric servo asymmetric.
///
/// Protects: linear servos from separate responses for up and down strokes, and from the sentence that their
/// differences are together more than noise. It is lower than that of the bounds, because a real asymmetry exceeds
/// tens of standard deviations. Evidence: the tests of the direction-split model.
pub const ASYMMETRY_FALSE_ALARM: f64 = 0.001;

/// Smallest difference between up and down strokes that counts, as a share of the stroke.
///
/// Protects: symmetric servos with limited speed or play, which differ by up to 1.4 % on simulated servos, outside
/// the bounds in one run of six. Evidence: the tests of the direction-split model.
pub const MATERIAL_ASYMMETRY: f64 = 0.02;

/// Smallest pivot of the equations of the direction-split model that counts: five digits of a column that the
/// others do not have.
///
/// Protects: users from separate responses that the record does not determine. Evidence: the tests of the
/// direction-split model.
pub const SEPARABLE: f64 = 1e-5;

/// Probability of a false alarm for hysteresis.
///
/// Protects: users from searching for play that does not exist. Evidence: the tests of the limits.
pub const HYSTERESIS_FALSE_ALARM: f64 = 0.001;

/// Probability of a false alarm for each end of the range.
///
/// Protects: users from searching for a stop that does not exist. Evidence: the tests of the limits.
pub const RANGE_END_FALSE_ALARM: f64 = 0.005;

/// Gain at an end of the range, relative to that elsewhere, below which the end softens.
///
/// Protects: users from searching for a stop where the gain varies a little. Evidence: the tests of the limits.
pub const SOFT_END: f64 = 0.9;

/// Gain at an end of the range, relative to that elsewhere, below which the end is a stop; see [`SOFT_END`].
pub const HARD_STOP: f64 = 0.1;

/// Levels needed to find a softening end: two for the gain at the end, and a median of the others.
///
/// Protects: users from a finding that rests on one other gain. Evidence: the tests of the limits.
pub const LEVELS_FOR_ENDS: usize = 4;

/// Strokes in one direction needed to look for a rate limit.
///
/// Protects: users from a law that a line through five points would give. Evidence: the tests of the limits.
pub const STROKES_FOR_RATE: usize = 6;

/// Ratio of the largest to the smallest stroke needed for that; see [`STROKES_FOR_RATE`].
pub const SIZES_FOR_RATE: f64 = 1.5;

/// Strokes above the hinge, and ratio of their sizes, needed to call a speed constant; see [`STROKES_FOR_RATE`].
pub const STROKES_AT_LIMIT: (usize, f64) = (5, 1.2);

/// Slopes of ln v over ln A: significantly below the first the speed is not proportional, below the second it is constant.
///
/// Protects: linear servos, whose slope is 1, from a rate limit that does not exist, and gradual saturation from being
/// called a limit. Evidence: the tests of the limits.
pub const RATE_SLOPES: (f64, f64) = (0.95, 0.25);

/// A hinge below this share of the largest size counts; see [`RATE_SLOPES`].
pub const HINGE: f64 = 0.9;

/// Travel per command, relative to that of the strokes with the farthest travel, below which a stroke was stopped.
///
/// Protects: the speed of free strokes from those that met a stop. Evidence: the tests of strokes that meet a stop.
pub const STOPPED: f64 = 0.9;

/// Level of each single test for a rate limit.
///
/// Protects: linear servos from a rate limit that does not exist. Evidence: the tests of the limits.
pub const RATE_LIMIT_LEVEL: f64 = 0.99;

/// Probability of rejecting the true order of a flight model.
///
/// Protects: users from an approximation that is stated as exact. Evidence: the tests of the flight model.
pub const ORDER_REJECTED: f64 = 0.01;

/// Difference of Bayes' criterion that is "not worth more than a bare mention" (Kass & Raftery, Journal of
/// the American Statistical Association, 1995). A parameter that improves the criterion by less is left out.
///
/// Protects: the delay of a flight model, which a needless lag would move out of its interval, because delay
/// and further lags are nearly interchangeable. Evidence: the tests of the flight model.
pub const BARE_MENTION: f64 = 2.0;

/// Time from 90 to 98 % of a stroke, relative to that at its highest speed, below which the motion is cut off.
///
/// Protects: users from times of a stop that are taken for those of the servo, and servos that are free from a stop that does not exist.
/// Evidence: the tests of the arrival.
pub const CUT_OFF: f64 = 1.25;

/// The same above which the servo slows down before its rest; see [`CUT_OFF`]. A stop up to 0.75 of the way to the command leaves it below.
pub const SLOWS_DOWN: f64 = 4.0;

/// Share of the travel by which a servo that is free goes beyond its rest at the least; see [`CUT_OFF`].
pub const PASSES_ITS_END: f64 = 0.01;
