//! Every threshold that decides what is chosen, found or withdrawn, in one table.
//!
//! Each entry says what it protects and where the evidence for its value is: a table of docs/method.md or
//! the test that fails when it is moved. Tolerances of the arithmetic (passes, rounding) stay in the files
//! that need them.
//!
//! One record is judged by several of these tests. How often a record of a linear servo is given any finding of
//! them is measured by the example `coverage`, stated in docs/method.md ("False alarms in all") and held by the
//! test `bands_of_automatic_structure_hold_as_often_as_they_say`.

// The choice of the settling time.

/// Standard deviations from its final value at which a response counts as still moving.
///
/// Protects: the end of the response from being cut off. Lower, noise passes for motion and N grows to the
/// longest; higher, tails are missed. Evidence: table "Measured coverage", staircase and PRBS.
pub const DETECTION: f64 = 4.0;

/// N must be this many times the settling time that is detected with it.
///
/// Protects: the part of a tail that noise hides. With 1.0 the whole curve is inside its band in 14-91 % of
/// runs, with 1.25 in 89-99 %, with 1.5 in as few as 90 % at strong noise. Evidence: "Measured coverage".
pub const MARGIN: f64 = 1.75;

/// Standard deviations by which a shorter response may differ from the longest one.
///
/// Protects: a response that rests for a while and moves again. It is the largest of as many differences as
/// the longest N has samples, hence above [`DETECTION`]. Evidence: "Measured coverage", plant E.
pub const CONTRADICTION: f64 = 4.75;

/// Ratio of the complete bank's band to the narrowest one above which frequencies are left out.
///
/// Protects: users from bands so wide that they say nothing. What it costs is the level, because a bank that
/// leaves frequencies out rests on an assumption. Evidence: "Poor references and coarse sensors",
/// Smooth(2) against Smooth(4).
pub const WIDE_COMPLETE_BAND: f64 = 3.0;

/// Share of the power of the changes of the input above a quarter of the sampling rate below which it is
/// smooth. Edges have a half.
///
/// Protects: the settling time under smooth inputs, which is then looked for in averages too. Evidence:
/// "Poor references and coarse sensors", Smooth(1) and Smooth(2).
pub const SMOOTH_SHARE: f64 = 0.1;

// Whether the errors are noise.

/// Probability below which a test of the errors against functions of the motion, against the noise at
/// standstill or between runs counts.
///
/// Protects: linear servos from being called nonlinear. Far below a single test's 1 %, because every recording
/// is tested and the bounds depend on it. Evidence: no finding in 3600 runs ("When the errors are not noise");
/// the tests of linearity.
pub const MISFIT_SIGNIFICANCE: f64 = 1e-4;

/// Percent of the motion (rms) that such a finding must explain.
///
/// Protects: users from findings of no consequence; in a long record anything is significant. Less is within
/// the changes of one servo from day to day. Evidence: table of the simulated servos in "When the errors are not noise".
pub const MATERIAL_MISFIT_PERCENT: f64 = 1.0;

/// Points of simulation fit that whitening may cost while the errors count as noise.
///
/// Protects: bounds whose noise model has absorbed errors of the model. On servos that the model can
/// represent it costs less than a tenth of a point. Evidence: the test of coarse sampling; "No advice without
/// cause" in "Measured coverage".
pub const WHITENING_COST_POINTS: f64 = 1.0;

/// Percent of the motion (rms) that the simulation of a servo that is not linear, or of runs that differ, may
/// leave before its bounds lose their level.
///
/// Protects: readers from bounds of a description that does not describe. On simulated servos with play, a
/// limited current and unequal ends, references of steps that are held leave 1 to 12 % of strokes of up to
/// 5 degrees, and their gains agree; random steps of 20 to 60 ms, sweeps and sums of sines leave 10 to 57 %, with
/// gains that are wrong by up to 45 % and delays by up to 24 ms. Evidence: table of the simulated servos.
pub const UNEXPLAINED_PERCENT: f64 = 15.0;

/// Share of the steps of the input that must be held until the response has come to [`FOLLOWED`] of its final
/// value, where the servo is not linear.
///
/// Protects: step responses that would be computed from motion without steps. Evidence: table of the
/// simulated servos, random steps of 20 to 60 ms.
pub const STEPS_FOLLOWED: f64 = 0.75;

/// Share of the final value beyond which a step has been followed; see [`STEPS_FOLLOWED`].
pub const FOLLOWED: f64 = 0.9;

/// By how much the input may move while it counts as held, as a share of its range. Inputs closer than this
/// are one level.
///
/// Protects: holds of an input that was measured, with noise of its own; it is less than a step. Evidence: the
/// recordings of real servos in the tests of the host.
pub const HELD_WITHIN: f64 = 0.02;

/// Points of fit within which predictions count as equal, so that the simplest is taken.
///
/// Protects: the choice by prediction from accidents. Evidence: the real recordings in the tests of the host.
pub const PREDICTION_TIE: f64 = 0.5;

/// Difference between two estimates of a step response, or bound of what may be missing in one, as a share of
/// its largest value or gain, beyond which the figures read from it are withheld.
///
/// Protects: readers from delays and rise times that depend on the estimator. Evidence: "Poor references and
/// coarse sensors", the column "told".
pub const DISAGREEMENT: f64 = 0.1;

// Findings beside the bounds.

/// Probability below which residuals count as not white, as dependent on the input, or runs as different.
///
/// Protects: users from models whose order is too low. Evidence: "False alarms of the residual tests".
pub const RESIDUAL_SIGNIFICANCE: f64 = 0.01;

/// Standard deviations by which the first readings of a run may miss the position of rest that was stated.
///
/// Protects: responses from a history that was not there, at no alarm in the tables of linear servos.
/// Evidence: the tests of the initial rest.
pub const INITIAL_REST_MISSED: f64 = 6.0;

// Beyond the linear model.

/// Probability of calling a symmetric servo asymmetric.
///
/// Protects: linear servos from separate responses for up and down strokes. It is lower than that of the bounds,
/// because a real asymmetry exceeds tens of standard deviations. Evidence: the tests of the direction-split model.
pub const ASYMMETRY_FALSE_ALARM: f64 = 0.001;

/// Smallest difference between up and down strokes that counts, as a share of the stroke.
///
/// Protects: symmetric servos with limited speed or play, which differ by up to 1.4 % on simulated servos, outside
/// the bounds in one run of six. Evidence: the tests of the direction-split model.
pub const MATERIAL_ASYMMETRY: f64 = 0.02;

/// Probability of a false alarm for hysteresis.
///
/// Protects: users from searching for play that does not exist. Evidence: the tests of the limits.
pub const HYSTERESIS_FALSE_ALARM: f64 = 0.001;

/// Probability of a false alarm for each end of the range.
///
/// Protects: users from searching for a stop that does not exist. Evidence: the tests of the limits.
pub const RANGE_END_FALSE_ALARM: f64 = 0.005;

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

/// Probability of a difference by chance below which the scatter of runs does not explain it.
///
/// Protects: the verdict "different" between recordings of one servo. Evidence: "Comparison", table of pairs.
pub const RUNS_DIFFER_SIGNIFICANCE: f64 = 0.01;

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

// Validation and comparison.

/// Errors of samples judged from rest relative to the others, up to which a run began at rest. The noise of the
/// first sample, from which all of them start, can make them √2 times as large.
///
/// Protects: the fit of a validation from beginnings that were not at rest. Evidence: the tests of validation.
pub const FROM_REST: f64 = 1.5;

/// Difference between the ends of two ranges, as a share of the larger range, up to which motions count as equally
/// large.
///
/// Protects: verdicts on servos that are not linear from references that differ. Evidence: the test of motions.
pub const EQUALLY_LARGE: f64 = 0.05;

/// Ratio of two usual holds up to which they count as equally long; see [`EQUALLY_LARGE`].
pub const EQUALLY_LONG: f64 = 1.25;

/// Delay shift below which two servos are called equally fast \[s\]: an eighth of a sample of the rig.
///
/// Protects: readers from shifts of no consequence. Evidence: the snapshot of a comparison.
pub const NOTABLE_SHIFT_S: f64 = 0.25e-3;
