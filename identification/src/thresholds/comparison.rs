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

/// Strokes from which a record shows whether it has several sizes; see [`SEVERAL_SIZES`].
pub const FEWEST_STROKES: usize = 8;

/// Ratio of the quartiles of the sizes of strokes from which they have several sizes.
///
/// Protects: servos that look linear under strokes of one size, and are slower over others, from being called different. Evidence: random levels have 1.5
/// and more in 998 of 1000 draws of 26 levels, and in 962 of 13; a square wave and stairs of equal steps have 1.
pub const SEVERAL_SIZES: f64 = 1.5;

/// Ratio of two typical sizes of strokes, and of two mean holds, up to which sides that both look linear under strokes of several sizes are compared as they are.
///
/// Protects: verdicts from the draw of random levels: two draws of 26 levels are within this in 999 of
/// 1000 pairs, of 13 in 985. Evidence: 448 pairs of draws of one servo each (linear, limited in speed both ways or one way, with friction, with play; noise of 0.2 to 8 % of the
/// amplitude; amplitudes up to 2.5 times apart): of 193 pairs that look linear and have bounds, one has responses that surely differ by more than 5 %, a servo that answers strokes
/// up and down differently, which are left out.
pub const SIZES_COMPARED: f64 = 2.0;

/// Delay shift below which two servos are called equally fast \[s\]: an eighth of a sample of the rig.
///
/// Protects: readers from shifts of no consequence. Evidence: the snapshot of a comparison.
pub const NOTABLE_SHIFT_S: f64 = 0.25e-3;

/// What a shift in time may leave of the difference between two responses that it is all of \[% of the final value\].
///
/// Protects: sentences that call a slower servo a later one. Evidence: a servo that is 5 % slower leaves 1.5 %, one that is 15 % slower 4.5 %.
pub const LEFT_BY_A_SHIFT_PERCENT: f64 = 2.0;

/// Correlation of an output with its command from which it shows the direction in which the servo turns.
///
/// Protects: a servo without bounds from being said to turn the other way. Evidence: 175 recordings of the simulated servos under all references, a third of
/// them without bounds. 161 show their direction by this and [`FOLLOWS_ONE_WAY`], all of them the right one.
pub const FOLLOWS_COMMAND: f64 = 0.5;

/// The same of the other direction, as a part of it, from which the record does not show which it is: a motion that repeats itself soon. See
/// [`FOLLOWS_COMMAND`].
pub const FOLLOWS_ONE_WAY: f64 = 0.5;
