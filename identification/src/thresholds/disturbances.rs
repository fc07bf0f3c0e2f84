//! What is in a record beside the servo and its noise: steps of the sensor, outliers, hum, slow ends, runs that differ.

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

/// Largest step of commands in motion, as a share of their range, that may be one of rounding.
///
/// Protects: pseudo-random commands of a few levels, which are exact, from an allowance of several times their bounds. Evidence: the
/// tests of rounded commands.
pub const ROUNDED_RANGE: f64 = 0.05;

/// Standard deviations of the noise in its column up to which a command is held.
///
/// Protects: holds from being divided by their noise: of normal noise 5 in 10 000 differences from the first sample are beyond. Evidence: table "Noise in the
/// column of the command".
pub const HELD_BUT_FOR_NOISE: f64 = 5.0;

/// Standard deviations by which a command changes between such holds.
///
/// Protects: smooth commands, and noise that is the command, from being taken for holds with noise, from one of which to the next they change by 6.3 at the most
/// (a motion of which four samples are within 5). Evidence: as [`HELD_BUT_FOR_NOISE`].
pub const CHANGED_BEYOND_NOISE: f64 = 7.0;

/// Standard deviation that second differences of what is within such holds show, as white noise has them, and that its neighbours on both sides do not say,
/// in that of all of it.
///
/// Protects: the tails of levels behind a lag, sweeps and sums of sines, which have .05 at the most, from being taken for noise; AR(1) noise of .95 has .18 and .22.
/// Evidence: the tests of noisy commands.
pub const ROUGHNESS_OF_NOISE: f64 = 0.1;

/// Standard deviations of an estimate by which noise in the column of the command must be able to move it, to be said beside bounds that allow for it.
///
/// Protects: readers from findings of no consequence: bounds are wider by an eighth at the most. Evidence: follows from the square root of 1 + 1/4.
pub const NOISE_MATTERS: f64 = 0.5;

/// Share that rounding of commands may have in what excites the part of the response that it changes.
///
/// Protects: sweeps whose column was rounded, from bounds at frequencies that only the rounding has. Evidence: the tests of
/// rounded commands.
pub const ROUNDED_EXCITATION: f64 = 0.9;

/// The same of noise in the column of the command.
///
/// Protects: bounds of stairs, whose equal holds leave much to the noise. Evidence: of stairs with AR(1) noise of 1 %, at 0.7 a quarter of the recordings had
/// bounds, of which up to two thirds did not hold the curve; at 0.6 none of the forty of that table has. Random levels have as many bounds with either.
pub const NOISY_EXCITATION: f64 = 0.6;

// What is in a record beside the servo and its noise.

/// Samples of Gaussian noise that are expected beyond the limit from which on one is taken out, in a whole record.
///
/// Protects: bounds from glitches and heavy tails, at no cost to noise without them, and users of long recordings from searching for glitches
/// that are none. The limit is 4.76 standard deviations of 3600 samples, and 5.35 of 80 000. Evidence: "Hard recordings".
pub const OUTLYING_BY_CHANCE: f64 = 0.007;

/// Share of the samples taken out that may be Gaussian noise: where there are outliers, the limit is lower than that of
/// [`OUTLYING_BY_CHANCE`].
///
/// Protects: bounds from outliers that hide behind each other. Evidence: "Hard recordings", glitches of 5 sd.
pub const FALSELY_OUTLYING: f64 = 0.01;

/// Share of the samples that may be outlying. More are not glitches.
///
/// Protects: records from being cut to what fits. Evidence: "Hard recordings", Student's t with 3 degrees of freedom has
/// 2 %.
pub const MOST_OUTLYING: f64 = 0.05;

/// Probability below which lasting outliers begin by chance with strokes of another size, where there are none elsewhere.
///
/// Protects: a servo with limited speed from being called linear where a short record has one half stroke, whose beginning is 1 to 3 % of its samples.
/// Evidence: of 120 square waves from the middle, 13 limited servos were called linear beside rows left out, and 2 with this. Of 760 linear servos,
/// most of them with glitches, one more was called not linear.
pub const OTHER_STROKES_ALONE: f64 = 0.05;

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
