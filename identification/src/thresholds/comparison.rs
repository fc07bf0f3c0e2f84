//! Validation and comparison.

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

/// Correlation of an output with its command from which it shows the direction in which the servo turns.
///
/// Protects: a servo without bounds from being said to turn the other way. Evidence: 175 recordings of the simulated servos under all references, a third of
/// them without bounds. 161 show their direction by this and [`FOLLOWS_ONE_WAY`], all of them the right one.
pub const FOLLOWS_COMMAND: f64 = 0.5;

/// The same of the other direction, as a part of it, from which the record does not show which it is: a motion that repeats itself soon. See
/// [`FOLLOWS_COMMAND`].
pub const FOLLOWS_ONE_WAY: f64 = 0.5;
