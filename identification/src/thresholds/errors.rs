//! Whether the errors are noise, and findings beside the bounds.

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

/// Speed of a limit that is held against errors, as a share of the fastest speed of the simulation. A linear response is faster than the servo in large
/// strokes.
///
/// Protects: servos whose speed is limited from being called linear in noise that is none. Evidence: shares of .5 and .7 find about as many.
pub const LIMITED_TO: f64 = 0.6;

/// Share of the squares of the errors from which on a limit of the speed is what makes them.
///
/// Protects: linear servos in noise so slow that a record has little of it. Evidence: the test of a motor under levels that change before it has
/// come to its top speed, of whose errors it explains far more, and the tests of linear servos in every noise.
pub const EXPLAINED_BY_LIMIT: f64 = 0.25;

/// Share of the steps of the input that must be held until the response has come to [`FOLLOWED`] of its final
/// value, where the servo is not linear.
///
/// Protects: step responses that would be computed from motion without steps. Evidence: table of the
/// simulated servos, random steps of 20 to 60 ms.
pub const STEPS_FOLLOWED: f64 = 0.75;

/// Motion in the second half of a hold, as a share of the response at its end, up to which a servo has come to rest there.
///
/// Protects: linear servos that ring from being called nonlinear since they move again after a hold. With 0.1, those of damping 0.4 and 0.5 are
/// still under way after some holds. Evidence: the test of servos that ring, over dampings, delays and holds.
pub const MOVES_AT_REST: f64 = 0.05;

/// Share of its largest value that a response must have come to within a hold; see [`MOVES_AT_REST`]. In its dead time a servo is at rest, too.
pub const ANSWERED_WITHIN_HOLD: f64 = 0.5;

/// Motion from the third to the last quarter of a hold, as a share of the stroke before, below which a servo rests there.
///
/// Protects: slow ends from being cut off with the hold. An exponential end whose time constant is the hold moves by a third of what is left of it
/// when the hold ends, so 1.5 % may be left; noise that hides more shows no rest. Evidence: the tests of rests within holds.
pub const MOVES_LITTLE: f64 = 0.005;

/// Probability below which such motion is not by chance.
///
/// Protects: slow ends that move by less than [`MOVES_LITTLE`]. A servo at rest that is not seen to be one is no loss. Evidence: as there.
pub const AT_REST_SIGNIFICANCE: f64 = 0.003;

/// Share of its largest value by which a response must move after a hold to contradict an output at rest.
///
/// Protects: linear servos that creep so slowly that no hold shows it. After strokes of 10 to 30 degrees in noise of 0.05, a creep of 1 % with
/// more than twice a hold is not seen within holds, and moves such a response by up to 2 %; play of 1 to 2 degrees moves it by 6 % and more.
/// Evidence: the tests of references that repeat themselves.
pub const MOVES_AFTER_HOLD: f64 = 0.03;

/// Strokes whose rests must be in the record.
///
/// Protects: slow ends that so few rests do not show among their noise. Evidence: as there.
pub const STROKES_FOR_REST: usize = 12;

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

/// Probability below which runs begin elsewhere than where the servo rests later.
///
/// Protects: final values from a first stroke that is longer or shorter than the others. Evidence: the tests of starts.
pub const START_SIGNIFICANCE: f64 = 1e-3;

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

/// Share of the square of errors that are not noise, in their means over four strokes, from which on they are slow: a quarter in a servo that is not linear.
///
/// Protects: linear servos behind a sensor that drifts from being called not linear, and servos that are not linear from a drift that is not there.
/// Evidence: the tests of slow errors.
pub const SLOW_ERRORS: f64 = 0.5;
