//! The stable prior, and the choice of settling time and frequencies.

// The stable prior.

/// Standard deviations by which the response under the stable prior may differ from that without it.
///
/// Protects: a response that does not die out evenly, such as one that rests for a while and moves again, from a band that is too
/// narrow. Evidence: table "Stable prior" of docs/method.md.
pub const PRIOR_CONTRADICTED: f64 = 4.0;

/// Standard deviation of a slow end, as a share of the gain, from which on the stable prior is not used: its kernels do not say of an end that
/// the noise hides how large it may be.
///
/// Protects: bands under the prior that a slow end leaves. Evidence: the lines with slow ends of table "Stable prior" of docs/method.md; the
/// single white noise there has .15 %, AR(2) noise .3 %, AR(1) noise 1 %.
pub const PRIOR_HIDDEN_END: f64 = 0.005;

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

/// Level of the bands among which the narrowest decides on the number of frequencies, whatever level is asked for.
///
/// Protects: the structure from depending on the level of its bounds. Evidence: "Measured coverage", smooth references.
pub const NARROWEST_AT: f64 = 0.99;

/// Longest settling time considered unless the options say otherwise \[samples\].
///
/// Protects: users from waiting; the choice takes time with the third power of it. Evidence: the servos of the
/// tables settle within a fifth of it.
pub const LONGEST_SETTLING: usize = 599;

/// Smallest N considered \[samples\]. A fast response under coarse sampling is over within a few samples, and its
/// curve could be shorter; but [`MARGIN`] covers the rest of a tail whose time constant is that of the motion before
/// it.
///
/// Protects: a slow end of a fast response, which is missed on so few samples: where 3 % of it took ten times as long,
/// the whole curve was inside its band in 13-78 % of runs with N from 9 on. Evidence: the tests of coarse sampling.
pub const SHORTEST_SETTLING: usize = 31;

/// Smallest longest N that leaves a choice \[samples\].
///
/// Protects: short records from spending more parameters on it. Evidence: the tests of poor records.
pub const SHORTEST_CHOICE: usize = 41;

/// Rows needed for each sample of the longest N; half as many where a record has no more.
///
/// Protects: the estimates of the noise, from which the bounds follow. Evidence: "Measured coverage", short records.
pub const ROWS_PER_SAMPLE: usize = 6;

/// Rows needed for each sample of N where bounds are not at stake, because only prediction counts.
///
/// Protects: the choice by prediction from responses that fit anything. Evidence: the real recordings in the tests of
/// the host.
pub const ROWS_FOR_PREDICTION: usize = 2;

/// Share of the samples that must then be left as rows.
///
/// Protects: three quarters of a record, from which the last quarter is predicted, from being used up by
/// histories. Evidence: the real recordings in the tests of the host.
pub const ROWS_KEPT: f64 = 0.74;

/// Share of the variance of a lag that the lags before it must leave, relative to what they brought themselves (median),
/// for the lag to count as resolved.
///
/// Protects: the response to an input that repeats itself. Exact repetition leaves rounding, 1e-12 or so; one edge in a
/// record of 10^6 samples that is not where it would repeat leaves more than 1e-6. Evidence: the tests of repetition.
pub const NOTHING_NEW: f64 = 1e-8;

/// Standard deviation of a slow end, in final values, above which nothing is known of what follows after N.
///
/// Protects: bounds of inputs that repeat themselves within little more than N, under which a slow end passes for another response that is over.
/// Evidence: "Inputs that repeat themselves".
pub const UNSEEN_END: f64 = 1.0;

/// Differences in a step response, as a share of the spread of the output, that do not matter to the choice.
///
/// Protects: records without noise from an N that follows rounding. Evidence: the test of a record without noise.
pub const IMMATERIAL_TAIL: f64 = 1e-5;

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

/// Largest share of the magnitude at the edge of a bank that may come from omitted frequencies.
///
/// Protects: bounds of the truncation bias; above it, that magnitude does not bound what is omitted. Evidence: the
/// tests of truncation; "Poor references and coarse sensors", Smooth(4).
pub const LEAKED_SHARE: f64 = 0.75;

/// Estimated relative error of an estimate through moments above which the rows themselves are factorised.
///
/// Protects: estimates from rounding, which must stay far below the noise of the best record; the rows cost several
/// times as long. Evidence: the tests that an ill-conditioned input goes through QR, and that counts far from zero
/// do not.
pub const MOMENT_ACCURACY: f64 = 1e-8;

/// Errors of a fit, as a share of the spread of the output, below which no levels are looked for that are off.
///
/// Protects: records without noise, in which the end of a response that N cuts off looks like a level that is off. Evidence: the test of radians beside degrees,
/// whose gain of a record without noise was wrong by 0.13 %.
pub const IMMATERIAL_ERROR: f64 = 1e-4;
