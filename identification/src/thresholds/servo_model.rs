//! The servo model.

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

/// Share of the squared errors beside noise that offsets of the runs must leave at the most, where the errors are not noise with them.
///
/// Protects: figures of servos that the model is lost on from offsets that make up for it. Evidence: a real R/C servo gets offsets of up to
/// 77 degrees, which leave 0.4; the simulated aircraft servo with zeros 0.2 and 0.3 degrees apart leaves less than 0.1.
pub const RUN_OFFSETS_LEAVE: f64 = 0.25;

/// Share of the squared errors beside noise that servos of the single runs leave at the most on the mean, for the servo to have changed between them.
///
/// Protects: servos that have something the model lacks, such as a linkage that is not linear, which the shorter runs by themselves do not show, from being said to have changed. Evidence:
/// the test of a servo that changed, and of one that did not and is behind such a linkage.
pub const RUNS_ALONE_LEAVE: f64 = 0.25;

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

/// Probability below which errors of a servo model follow the command, or are those of a part that the equation lacks: seven tests, of which
/// one in a hundred right models fails any. So unlikely is also another servo beside which its errors are larger by chance.
///
/// Protects: the intervals of servos outside of the model's class. Evidence: table "Measured coverage" of docs/servo-model.md. At 0.01 for each test,
/// recordings outside of the class have intervals a tenth less often, which hold as often.
pub const SERVO_LACK_OF_FIT: f64 = 0.0015;

/// Probability below which a servo of other terms, whose errors are larger, is not a possible one beside the best.
///
/// Protects: intervals, which contain all possible servos. It is the share of right ones that they may leave out. Evidence: as there.
pub const SERVO_ALTERNATIVE: f64 = 0.01;

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

/// Probability below which last rests that fall short of the line through the others are no chance.
///
/// Protects: bounds of stairs whose last level alone lies beyond a stop. Evidence: the table of stops in docs/assumptions.md.
pub const SHORT_LEVEL_SIGNIFICANCE: f64 = 1e-4;

/// Friction that holds the shaft so many times as far off the command as it is at any rest is shown by nothing.
///
/// Protects: small strokes in files and predictions, which such friction holds, as of a servo that rests within 12 us and had a model that stood still under 50: lost as soon as the shaft turns, it moves where strokes end by less than a step of the
/// sensor, as noise may ask for. Evidence: the test `friction_that_no_rest_shows_is_left_open`, and the rows of friction in the table "Measured coverage" of docs/servo-model.md.
pub const SERVO_FRICTION_UNSHOWN: f64 = 2.0;
