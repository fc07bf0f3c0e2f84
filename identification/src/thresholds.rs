//! The thresholds that decide what is chosen, found or withdrawn, in one table.
//!
//! Each entry says what it protects and where the evidence for its value is: a table of docs/method.md or
//! the test that fails when it is moved. How a test is built (its lags, blocks and windows, and the least data that it can be computed
//! from) and tolerances of the arithmetic (passes, rounding) stay in the files that need them. So do the thresholds of what the host
//! finds in files and recordings, such as commands that were written between the rows.
//!
//! One record is judged by several of these tests. How often a record of a linear servo is given any finding of
//! them is measured by the example `coverage`, stated in docs/method.md ("False alarms in all") and held by the
//! test `bands_of_automatic_structure_hold_as_often_as_they_say`.

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

// The steps of the sensor.

/// Share of samples equal to the one before, above which the output may have steps.
///
/// Protects: smooth outputs from an allowance that they do not need. Evidence: "Poor references and coarse
/// sensors", steps of 0 to 0.3.
pub const REPEATED: f64 = 0.1;

/// Differences of up to this many steps must be whole multiples of the step. Larger ones may have been rounded
/// again.
///
/// Protects: outputs without steps, whose smallest difference is an accident. Evidence: the tests of quantisation.
pub const MULTIPLES: f64 = 3.5;

/// Tolerance of a whole multiple, as a share of the step; see [`MULTIPLES`].
pub const MULTIPLE_WITHIN: f64 = 0.1;

/// Share of the small differences that must be whole multiples; see [`MULTIPLES`].
pub const ON_GRID: f64 = 0.95;

/// Residuals (rms) below this share of a step do not dither. Normal noise of half a step and the rounding together
/// give sqrt(1/4 + 1/12).
///
/// Protects: bounds of gains, which rounding without dither moves alike in every repetition. Evidence: "Poor references
/// and coarse sensors", steps of 0 to 0.3.
pub const DITHERED: f64 = 0.577;

/// Residual variance \[squared steps\] that rounding alone can cause: twice that of uniform errors, because the errors
/// at a few levels of rest need not be uniform; see [`DITHERED`].
pub const OF_ROUNDING: f64 = 1.0 / 6.0;

// What is in a record beside the servo and its noise.

/// Standard deviations one step ahead beyond which a sample is taken out.
///
/// Protects: bounds from glitches and heavy tails, at no cost to noise without them: of 3600 Gaussian errors 0.007
/// are beyond. Evidence: "Hard recordings".
pub const OUTLYING: f64 = 4.75;

/// Share of the samples that may be outlying. More are not glitches.
///
/// Protects: records from being cut to what fits. Evidence: "Hard recordings", Student's t with 3 degrees of freedom has
/// 2 %.
pub const MOST_OUTLYING: f64 = 0.05;

/// How many times as far as usual a single sample stands out of the course of the errors on both sides to be a spike.
///
/// Protects: records of servos that are not linear from glitches, whose errors pass for those of the servo. Gaussian errors
/// do not stand out as far, and no error of 50 simulated servos did. Evidence: the test of glitches under a limited servo.
pub const SPIKE: f64 = 5.0;

/// What is usual is this quantile of how far samples stand out: spikes are fewer than [`MOST_OUTLYING`], so it is not one of them.
///
/// Protects: as [`SPIKE`], from spikes that would raise what is usual. Evidence: follows from [`MOST_OUTLYING`]; the test of glitches under a
/// limited servo.
pub const SPIKE_SCALE_QUANTILE: f64 = 0.95;

/// Ratio of a line in the spectrum of the errors to its neighbours above which it is hum.
///
/// Protects: noise from being called periodic, which 25 did in 3 % of records; a sine of a third of the noise is 300
/// times its neighbours in 4000 samples. Evidence: "Hard recordings", hum.
pub const ABOVE_NEIGHBOURS: f64 = 50.0;

/// Ratio of a line in the spectrum of the reference to its neighbours above which a line of the errors there is not hum.
///
/// Protects: servos that are not linear under strokes of one length. Evidence: the tests of linearity.
pub const LINE_OF_REFERENCE: f64 = 25.0;

/// Gain at a frequency, relative to that at rest, from which on the servo follows it: a line of the errors at the rate of the changes of the
/// reference may be the servo's.
///
/// Protects: servos with unequal speeds or a load, under equal holds, from passing for linear ones beside hum; and mains hum at the rate of
/// frames of 20 ms, which servos hardly follow. Evidence: the tests of linearity; "Hard recordings", hum.
pub const HARDLY_FOLLOWED: f64 = 0.2;

/// Amplitude of a line in the errors, relative to that of the motion at the same frequency, above which it is not an
/// error of the model.
///
/// Protects: servos that are not linear, whose errors have the frequencies of the reference. Evidence: the tests of the
/// limits.
pub const BESIDE_MOTION: f64 = 0.1;

/// Probability below which an end of the response beyond N counts. Then N is the longest, and an end beyond that takes the level.
///
/// Protects: step responses that end too soon. A longer N makes bounds three times as wide, in one of 300 records without such an end;
/// bounds contain ends that are not found. Evidence: "Hard recordings", two time scales.
pub const SLOW_END_SIGNIFICANCE: f64 = 3e-3;

/// The same where no N was found in the record.
///
/// Protects: bounds of a response that is not over. Evidence: "Hard recordings", two time scales; plant E of "Measured coverage" keeps
/// its level.
pub const UNSETTLED_SIGNIFICANCE: f64 = 0.02;

/// Standard deviations that the end of the response may have after the longest N, extrapolated from where it is last
/// seen, before bounds lose their level.
///
/// Protects: bounds of a response that still moves when the longest N ends. Evidence: "Hard recordings", two time
/// scales; plant E of "Measured coverage" keeps its level.
pub const UNSETTLED_END: f64 = 1.5;

/// Runs from which on bounds are those of the servo's mean.
///
/// Protects: readers from bounds of a mean by two runs, whose scatter has one degree of freedom. Evidence: "Hard
/// recordings", scatter of gain.
pub const RUNS_FOR_MEAN: usize = 3;

/// Probability below which runs differ, where it is asked whether a finding of their common fit is of that alone. The bounds do not
/// ask: they contain how runs differ, whether that is beyond chance or not.
///
/// Protects: records of runs that differ from being taken for a closed loop. Evidence: the tests of runs with different gains.
pub const SCATTER_SIGNIFICANCE: f64 = 0.05;

// Whether the errors are noise.

/// Probability below which a test of the errors against functions of the motion, against the noise at
/// standstill or between runs counts.
///
/// Protects: linear servos from being called nonlinear. Far below a single test's 1 %, because every recording
/// is tested and the bounds depend on it. Evidence: no finding in 3600 runs ("When the errors are not noise");
/// the tests of linearity.
pub const MISFIT_SIGNIFICANCE: f64 = 1e-4;

/// Percent of the motion (rms) that such a finding must explain; of functions of the motion, where they explain most.
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

/// Condition number beyond which parts of a record do not determine a bank. Far below it rounding is already
/// visible, but small beside what the noise leaves open.
///
/// Protects: the ranking by prediction from records whose parts cannot stand for one another, such as one step in
/// each. Evidence: the real recordings in the tests of the host.
pub const DETERMINED_BY_PARTS: f64 = 1e9;

/// Difference between two estimates of a step response, or bound of what may be missing in one, as a share of
/// its largest value or gain, beyond which the figures read from it are withheld.
///
/// Protects: readers from delays and rise times that depend on the estimator. Evidence: "Poor references and
/// coarse sensors", the column "stated".
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

/// Shortest stretch of rest that shows the noise at standstill \[samples\].
///
/// Protects: that noise from the end of a motion. Evidence: the tests of the noise at standstill.
pub const SHORTEST_REST: usize = 32;

/// Fewest samples that determine the noise at standstill, or that in motion.
///
/// Protects: linear servos from an alarm by chance. Evidence: the tests of the noise at standstill.
pub const FEWEST_AT_REST: usize = 100;

/// One in so many pieces of motion is left out of the noise in motion: the loudest.
///
/// Protects: linear servos whose line has single glitches. Evidence: the tests of the noise at standstill.
pub const LOUDEST_LEFT_OUT: usize = 5;

// Beyond the linear model.

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

// The input.

/// Probability below which inputs to come explain the output.
///
/// Protects: bounds of recordings in closed loop, which are those of a mixture of servo and controller. Evidence: table "Closed loop".
pub const FEEDBACK_SIGNIFICANCE: f64 = 1e-3;

/// Standard deviations by which the response at lag 0 must be against the rest of it; chance does so once in 740.
///
/// Protects: as [`FEEDBACK_SIGNIFICANCE`], where the reference is held and the noise drifts. Evidence: at 4, bands of loops with a
/// gain of 0.6 missed the truth in 8 of 38, 7 of these at lag 0, where a band leaves the truth out from 3.3 on.
pub const AGAINST_MOTION: f64 = 3.0;

/// Share of what is new in an input, beyond its own past, from which on past outputs make it.
///
/// Protects: users from a servo model of what is a controller, or of a servo whose columns are exchanged. Evidence: 51 recordings, real and
/// simulated, with planned commands have 0.2 or less; the recorded voltage of a motor's controller has 0.85, exchanged columns that jump have
/// 0.47 to 0.96.
pub const INPUT_EXPLAINED: f64 = 0.4;

/// Share of the samples with an output that is not straight at which the input is, from which on it was planned.
///
/// Protects: planned commands from being taken for those of a controller. Evidence: triangles and squares of a real R/C servo have 0.93,
/// stairs of a motor 0.99; simulated loops have 0.002, and 0.55 to 0.81 where the command is rounded to 13 to 100 times what the noise makes
/// of it.
pub const PLANNED: f64 = 0.9;

/// Share of the largest value of the step response from which on such a response is evident though the errors are no noise.
///
/// Protects: servos that are not linear from being taken for a closed loop. Evidence: table "Closed loop".
pub const EVIDENT_SHARE: f64 = 0.1;

/// Share of the largest value of the step response from which on the response at lag 0 is all of it.
///
/// Protects: bounds of recordings of a regulator alone, u = -K y, where they are narrow, and those of -1/K. Evidence: the test of a regulator
/// alone.
pub const ALL_AT_ONCE: f64 = 0.95;

/// Correlation of input and output with the output ahead, from which on a lead is looked at.
///
/// Protects: records without relation between the two, which are most alike anywhere. Evidence: the tests of exchanged columns.
pub const LEADING_CORRELATION: f64 = 0.4;

/// By how much the square of that correlation must exceed the square of the largest with the input ahead: the share of the motion that
/// only the lead explains.
///
/// Protects: periodic references, under which lag and lead look alike. Evidence: all 31 recordings, real and simulated, with noise up to
/// that of the motion, whose columns were exchanged exceed it by 0.024 or more; none with its own columns exceeds 0.
pub const LEADING_ADVANTAGE: f64 = 0.02;

/// Share of the changes of the output that must come at multiples of one time for it to be that of a slow sensor.
///
/// Protects: times of recordings whose sensor is refreshed less often than rows are written, which are late by up to that. Evidence: the tests
/// of held outputs; in time, half of all changes come an odd number of samples apart.
pub const HELD_OUTPUT_SHARE: f64 = 0.95;

/// Share of changes of a single step of the sensor from which on these steps, and not its refresh, keep the output in place.
///
/// Protects: coarse sensors in slow motion from being called slow. Evidence: the tests of held outputs, with steps of 0.09 to 1 under strokes
/// of about 10; half is by choice.
pub const ONE_STEP_SHARE: f64 = 0.5;

/// Probability below which a lag that changes along the record is no chance.
///
/// Protects: bounds of recordings whose two columns have clocks that differ, and of servos that change. Evidence: the tests of clocks.
pub const LAG_DRIFT_SIGNIFICANCE: f64 = 1e-5;

/// Change of the lag over a run that matters \[samples\]; see [`LAG_DRIFT_SIGNIFICANCE`].
pub const LAG_DRIFT_SAMPLES: f64 = 0.25;

/// Ratio of the ranges of the command in both halves of a run up to which its lag is asked for.
///
/// Protects: servos that are not linear, which answer another motion sooner or later, from a drift of the lag. Evidence: table "Times that are
/// not what they seem, and stops" of docs/method.md, whose one recording in forty without a finding has such a command.
pub const RANGES_ALIKE: f64 = 1.25;

/// The same of how far the command goes in all: of a few dozen random levels halves differ by up to two times, of sweeps and of holds that
/// get shorter by three times or more. Protects and evidence: as [`RANGES_ALIKE`].
pub const WAYS_ALIKE: f64 = 2.5;

/// Share of the gain elsewhere below which the output does not follow the command at an end of its range: it stands at a stop.
///
/// Protects: servos whose gain falls towards the end of the travel, or that have a dead band, from being called stopped.
/// Evidence: the tests of stops.
pub const STOP_GAIN: f64 = 0.1;

/// Share of the range by which it must be short of where it would go; see [`STOP_GAIN`].
pub const STOP_SHARE: f64 = 0.05;

/// Samples in a row at the farthest output, where the model goes beyond it, that count as a stroke to a stop.
///
/// Protects: peaks of the motion, which the noise puts at the farthest output for a sample or two. Evidence: the lines without a stop of the
/// table of stops in docs/method.md, which have none in 80 recordings; by choice, not tuned.
pub const STOP_SAMPLES: usize = 5;

/// Standard deviations from which on an output that stays behind the model at its farthest is beyond chance.
///
/// Protects: bounds of recordings in which a few strokes end at a stop. Evidence: the table of stops in docs/method.md.
pub const STOP_SIGNIFICANCE: f64 = 6.0;

/// Travel of an output that stands still, as a share of its whole travel.
///
/// Protects: servos that are slow, rest, or follow small strokes, from being called stopped; and bounds of recordings in which the servo is
/// switched off. Evidence: the tests of servos that stop, and of a servo that dies under random levels.
pub const STANDSTILL_TRAVEL: f64 = 0.1;

/// The part of a run, at least, in which the output stands still, and in which it moves; see [`STANDSTILL_TRAVEL`].
pub const STANDSTILL_PART: f64 = 0.1;

/// What counts as a stroke of the input then, as a share of its travel: one to another level of some stairs, or across all of two.
pub const STANDSTILL_STROKE: f64 = 0.3;

/// Travel of an output that follows a stroke, as a share of its whole travel; see [`STANDSTILL_TRAVEL`].
pub const STANDSTILL_FOLLOWED: f64 = 0.25;

/// Strokes of the input that show that the output should move; see [`STANDSTILL_TRAVEL`].
pub const STANDSTILL_STROKES: usize = 3;

/// How long the longest of the strokes that are not followed is, at least, relative to the shortest that was; see [`STANDSTILL_TRAVEL`].
pub const STANDSTILL_AS_LONG: f64 = 0.7;

/// Standard deviations from which on motion before the changes of a held command is beyond chance.
///
/// Protects: recordings whose command was written in time from being called late. Evidence: the tests of early motion, where
/// it is below 3 in time, also with servos that ring or creep, and above 10 where 8 ms of motion come first.
pub const EARLY_SIGNIFICANCE: f64 = 6.0;

/// Share of the stroke that must have been made when the command changes; see [`EARLY_SIGNIFICANCE`].
pub const EARLY_SHARE: f64 = 0.005;

/// How many times larger it must be than any of the motions before it: a servo that has not come to rest, or rings, moves in these, too.
///
/// Protects: servos that ring or creep from a late command. Evidence: the test that such a servo is not early, with damping ratios of 0.05 to
/// 4; the lead after which a late command is found in the test beside it.
pub const EARLY_TO_EARLIER: f64 = 3.0;

/// Share of the clearest early motion that a window must have to be said to be as long.
///
/// Protects: users from a lead that is longer than that of their logger. Evidence: the tests of late commands, where the lead is half of the
/// true one or more, and no longer by more than three samples.
pub const EARLY_WHOLE: f64 = 0.9;

/// Changes of the command from which on the scatter of the motions before them shows what chance does.
///
/// Protects: short recordings from a finding by a few strokes. Evidence: by choice: a t of nine degrees of freedom is above
/// [`EARLY_SIGNIFICANCE`] once in 10 000.
pub const EARLY_CHANGES: usize = 10;

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

/// The same of random levels, whose ends are random too.
///
/// Protects: verdicts on two recordings of one generator with other seeds. The ends of 20 uniform draws are within 25 % of the range of
/// those of 20 others in 99 of 100 pairs (20 000 pairs drawn). Whatever the ranges differ by is then left out of "different".
pub const RANDOM_ENDS: f64 = 0.25;

/// Ratio of two usual holds up to which they count as equally long; see [`EQUALLY_LARGE`].
pub const EQUALLY_LONG: f64 = 1.25;

/// Delay shift below which two servos are called equally fast \[s\]: an eighth of a sample of the rig.
///
/// Protects: readers from shifts of no consequence. Evidence: the snapshot of a comparison.
pub const NOTABLE_SHIFT_S: f64 = 0.25e-3;

// The servo model.

/// Standard deviations by which a record must exclude a servo without the limit of one direction, for that limit to have been at work.
///
/// Protects: intervals of top speeds and accelerations of a direction in which the servo never needed all of its drive. Evidence: the
/// test of limits that were not at work.
pub const SERVO_LIMIT_AT_WORK: f64 = 4.0;

/// Advantage of a term in predicting blocks that the fit has not seen, in standard errors of its mean over the blocks, from
/// which on the term is taken. One in a thousand advantages of nothing is larger, and about ten terms are tried.
///
/// Protects: linear servos from terms that they do not have. Evidence: the test that linear servos stay linear.
pub const SERVO_TERM_ADVANTAGE: f64 = 3.0;

/// Share of the squared errors in parts not seen that terms beyond a linear servo must take away: less is within what the
/// integration in steps and chance do, and matters to no prediction.
///
/// Protects: linear servos from terms that they do not have. Evidence: the test that linear servos stay linear.
pub const SERVO_MATERIAL_ADVANTAGE: f64 = 0.05;

/// Share of the squared errors in parts not seen from which on a term is kept whatever the scatter of its advantage: a few blocks
/// of sticking decide the scatter.
///
/// Protects: prediction of servos with friction. Evidence: without it the friction of the gears was taken from a recording of a
/// smart servo with a weight, which then predicted others to 82 and 78 % instead of 94 and 89.
pub const SERVO_LARGE_ADVANTAGE: f64 = 0.25;

/// Share of the squared errors that offsets of the runs must leave at the most, where the errors are not noise with them.
///
/// Protects: figures of servos that the model is lost on from offsets that make up for it. Evidence: a real R/C servo gets offsets of up to
/// 77 degrees, which leave 0.4; the simulated aircraft servo with zeros 0.2 and 0.3 degrees apart leaves less than 0.1.
pub const RUN_OFFSETS_LEAVE: f64 = 0.25;

/// Advantage of the linear model over the servo model in the fit of parts that neither has seen, from which on the linear one is
/// recommended \[percentage points\].
///
/// Protects: users from a servo model that predicts worse than the model beside it. Evidence: the table of linear models in
/// `docs/servo-model.md`; on a linear servo the two differ by less.
pub const LINEAR_MODEL_ADVANTAGE: f64 = 0.5;

/// Share of the motion that a model must predict, rms, beyond what noise explains of the errors \[%\].
///
/// Protects: users from a sentence about a servo that stands on a model which does not predict it. Evidence: of right models the motion
/// predicted is 81 to 100 %, on all recordings in the tests of the host and on simulated servos with noise up to twice their motion; of exchanged
/// columns it is 0 to 70 %, and 74 % where two controllers are taken for one.
pub const POOR_PREDICTION_PERCENT: f64 = 75.0;

/// Share of the variance of the output that must be motion.
///
/// Protects: users from findings on an output that has nothing of the input in it. Evidence: servos whose noise is twice their motion
/// leave 0.17, columns without relation less than 0.03.
pub const MOTION_IN_NOISE: f64 = 0.1;

/// Ratio of the mean squares of errors one step ahead in motion and at rest, up to which they are the same noise.
///
/// Protects: the intervals of servo models that are wrong in motion. Evidence: the coverage table of servo models.
pub const MOTION_NOISE_RATIO: f64 = 1.25;

/// Standard errors by which the logarithm of that ratio must exceed zero; chance does so once in 30 000.
///
/// Protects: right servo models from being refused. Evidence: as for [`MOTION_NOISE_RATIO`].
pub const MOTION_NOISE_CHANCE: f64 = 4.0;

/// Probability below which errors of a servo model follow the command, or are those of play.
///
/// Protects: the intervals of servos outside of the model's class. Evidence: as for [`MOTION_NOISE_RATIO`].
pub const SERVO_LACK_OF_FIT: f64 = 0.01;

/// Levels of the command from which on a record distinguishes gain, offset, friction, dead band and load: each shapes the line through the
/// positions of rest, and between two of these any fits.
///
/// Protects: intervals of servos that seem to have none of them, have them all the same, and do not follow a third level as the model does.
/// Evidence: the test that two levels have no intervals.
pub const SERVO_LEVELS: usize = 3;

/// Probability with which what the equation lacks is above its upper limit.
///
/// Protects: bands and intervals of servo models, which contain that limit. Evidence: the test that the limit holds a discrepancy below the noise.
pub const DISCREPANCY_MISSED: f64 = 0.01;

/// Ratio of the upper bound to the lower from which on a positive quantity is not determined: neither its order of magnitude nor anything that
/// follows from it is then known.
///
/// Protects: users from a number that says nothing. Evidence: by choice, stated in docs/servo-model.md.
pub const UNDETERMINED_RATIO: f64 = 10.0;

/// Distance of the servo from the command to the largest of the record, up to which the record says what the servo does there.
///
/// Protects: bands under larger strokes than were recorded, where limits act that did not show. Evidence: the coverage table of
/// servo models: of commands of the recorded kind, 100 of 109 in the class keep their band.
pub const SERVO_ERROR_BEYOND_RECORD: f64 = 1.25;

/// Share of the upper bound of its top speed that a servo must reach in the record for it to be determined.
///
/// Protects: users from a top speed that the equation extrapolates. Evidence: of 141 intervals on servos in the class and
/// outside of it, those that missed with less than this share were 8 of 31, those with more 9 of 110, by the value. Of 7 that the value let pass on
/// servos with stiction under stairs in coloured noise, 4 missed: a value that is too low is reached for that reason alone.
pub const SERVO_TOP_SPEED_REACHED: f64 = 0.5;

/// Probability below which a last level that falls short of the line through the others is no chance.
///
/// Protects: bounds of stairs whose last level alone lies beyond a stop. Evidence: the table of stops in docs/method.md.
pub const SHORT_LEVEL_SIGNIFICANCE: f64 = 1e-4;
