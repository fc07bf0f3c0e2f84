//! The settling time, the number of frequencies and the noise order, chosen from the data.
//!
//! **Settling time.** One long fit (N as long as the record allows) gives, through the nesting of
//! Cholesky factors, the step response of every shorter N. For each N of a grid the time N0 is
//! detected after which the response stays within [`DETECTION`](crate::thresholds::DETECTION) standard deviations
//! of its final value. The shortest N is taken that is at least [`MARGIN`](crate::thresholds::MARGIN) times its own
//! N0 and that the long fit does not contradict. Detection ends where a tail sinks into the noise; the margin
//! covers the rest of the tail, which a band of a fraction of that width would otherwise miss.
//!
//! **Frequencies.** All of them, n = N: only a complete bank has a band whose label is earned. Where
//! the input lacks high frequencies, that band would be useless; then n is what makes the band of noise
//! *and* truncation together narrowest.
//!
//! **Noise order.** Bayes' information criterion over 0..8, at every pass of the alternation.

use super::settling_candidates::Choice;
use super::settling_search::Search;
use super::{complete_bank, repetition, shorter_history, smooth_input};
use crate::error::Error;

/// A way to a candidate; `None` where the input does not determine one.
type Proposal = fn(&Search<'_>) -> Option<Choice>;

/// The ways to a candidate in their order: the first that comes to one is taken.
const PROPOSALS: [Proposal; 4] = [
    // All frequencies, any N up to the longest that the record supports.
    complete_bank::choose,
    // All frequencies, any N up to where the input repeats itself.
    repetition::choose,
    // Either of these with a shorter longest N, which leaves more rows.
    shorter_history::choose,
    // As many frequencies as make the band narrowest.
    smooth_input::choose,
];

/// Chooses N, and n where the input lacks high frequencies.
///
/// # Errors
/// The input does not even excite a constant gain.
pub(crate) fn choose_settling(search: &Search<'_>) -> Result<Choice, Error> {
    PROPOSALS
        .iter()
        .find_map(|proposal| proposal(search))
        .ok_or(Error::nothing_excited(search.longest))
}
