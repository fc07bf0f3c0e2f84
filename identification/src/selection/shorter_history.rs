//! Candidate: all frequencies, with a shorter longest N.
//!
//! A step that comes after a rest is only in rows whose history begins in that rest. Where the longest N is
//! longer than the rests, no row has a step in its recent past, and nothing seems to excite the response.
//! A smooth input has no such steps, and gains nothing from other rows.

use super::settling_candidates::Choice;
use super::settling_range::shorter;
use super::settling_search::Search;
use super::{complete_bank, repetition};
use crate::data::Moments;
use crate::estimation::Excitation;

/// The first choice among shorter longest N that is of a complete bank.
pub(crate) fn choose(search: &Search<'_>) -> Option<Choice> {
    let record = search.record?;
    let noise_lags = search.moments.output_lags() - 1;
    shorter(search.longest).find_map(|longest| {
        let moments = Moments::of_record(record, longest + noise_lags, noise_lags + 1);
        if Excitation::of(&moments).is_smooth() {
            return None;
        }
        let search = Search {
            moments: &moments,
            longest,
            ..*search
        };
        complete_bank::choose(&search).or_else(|| repetition::choose(&search))
    })
}
