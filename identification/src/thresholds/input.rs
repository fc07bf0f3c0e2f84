//! Whether the input is what moved the servo, when it says, all along the record.

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

/// Part by which the speed of strokes changes along a record, beyond chance, that matters.
///
/// Protects: readers from changes of no consequence; servos differ by as much from day to day. Evidence: the tests of strokes that get slower.
pub const SPEED_DRIFT: f64 = 0.05;

/// Change of the gain over a run that matters \[%\]; see [`LAG_DRIFT_SIGNIFICANCE`].
///
/// Protects: users from findings of no consequence, since the estimate is that of the mean gain; less is within the changes of one servo from day to day.
/// Evidence: by choice, not tuned; "Gains that change, and slow servos" in docs/assumptions.md has what is found below and above it.
pub const GAIN_DRIFT_PERCENT: f64 = 2.0;

/// Share of the changes of the output that a lag must explain for the servo to be called a slow one.
///
/// Protects: servos that are limited, or not linear, from the advice to record longer. Evidence: the recordings of "Gains that change, and slow servos" in
/// docs/assumptions.md, in which a lag explains up to 94 % of servos whose speed is limited, and less than 95 % of slow lags only where they hardly move
/// beside their noise, as under a PRBS.
pub const EXPLAINED_BY_LAG: f64 = 0.95;

/// Time constants in the longest settling time, below which the response is not over: a lag is within 2 % after four.
///
/// Protects: lags that the longest settling time holds, and fast servos that are not linear, of which a lag may explain 99 %. Evidence: as [`EXPLAINED_BY_LAG`].
pub const LAG_BESIDE_SETTLING: f64 = 4.0;

/// Ratio of the ranges of the command in both halves of a run up to which its lag is asked for.
///
/// Protects: servos that are not linear, which answer another motion sooner or later, from a drift of the lag. Evidence: table "Times that are
/// not what they seem, and stops" of docs/assumptions.md, whose one recording in forty without a finding has such a command.
pub const RANGES_ALIKE: f64 = 1.25;

/// The same of how far the command goes in all, and of how often it moves: of a few dozen random levels halves differ by up to two times, of sweeps and of holds that
/// get shorter by three times or more. Protects and evidence: as [`RANGES_ALIKE`].
pub const WAYS_ALIKE: f64 = 2.5;

/// Share of the gain elsewhere below which the output does not follow the command at an end of its range: it stands at a stop.
///
/// Protects: servos whose gain falls towards the end of the travel, or that have a dead band, from being called stopped.
/// Evidence: the tests of stops.
pub const STOP_GAIN: f64 = 0.1;

/// Share of the way of a line by which rests at an end are short of it at the least.
///
/// Protects: linkages and sensors whose errors are the same at each visit of a level from being called stops, where an end is hardly short; larger
/// errors of few levels pass all the same. Evidence: the test of levels that are off alike at each visit.
pub const STOP_SHORT: f64 = 0.01;

/// Samples in a row at the farthest output, where the model goes beyond it, that count as a stroke to a stop.
///
/// Protects: peaks of the motion, which the noise puts at the farthest output for a sample or two. Evidence: the lines without a stop of the
/// table of stops in docs/assumptions.md, which have none in 80 recordings; by choice, not tuned.
pub const STOP_SAMPLES: usize = 5;

/// Standard deviations from which on an output that stays behind the model at its farthest is beyond chance.
///
/// Protects: bounds of recordings in which a few strokes end at a stop. Evidence: the table of stops in docs/assumptions.md.
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

/// Half width of a bound at the ends of the band that a smooth input excites, as a share of the response: .9 dB, or 5.7 degrees.
///
/// Protects: readers from a band that ends in bounds of no use. Evidence: none is needed, since bounds hold at any width; those of a sweep go from a tenth of
/// this to ten times it within a few percent of frequency.
pub const WIDEST_IN_BAND: f64 = 0.1;
